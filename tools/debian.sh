#!/usr/bin/env bash
# `./run` on another Debian: ./run test-trixie [pytest arguments], ./run trixie COMMAND ..., the same with sid
#
#   debian.sh SUITE SNAPSHOT CHROOT USER_HOME COMMAND [ARGUMENTS]
#
# `./run` calls it as root with a copy of the checkout. The first call makes the Debian by debootstrap in
# CHROOT (from $DEBIAN_MIRROR, or the mirror of this machine), later ones reuse it. All mounts are in a
# mount namespace of this process and end with it, however it ends: no other program ever sees them, and
# CHROOT can be deleted like any folder.
set -euo pipefail

say() { printf 'isthmus: %s\n' "$*" >&2; }
die() { say "$@"; exit 1; }

if [ -z "${ISTHMUS_NAMESPACE-}" ]; then
    unshare --mount true 2>/dev/null ||
        die "root may not mount here (in a container? start it with --privileged), so that no Debian can run."
    ISTHMUS_NAMESPACE=1 exec unshare --mount --pid --fork --kill-child -- bash "${BASH_SOURCE[0]}" "$@"
fi
suite=$1 snapshot=$2 chroot=$3 user_home=$4
shift 4

# --- a Debian ---------------------------------------------------------------------------------------

get_debootstrap() {
    command -v debootstrap >/dev/null && return
    command -v apt-get >/dev/null || die "please install debootstrap first."
    say "installing debootstrap (log: $chroot.log)"
    {
        apt-get -q update &&
            DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends \
                debootstrap debian-archive-keyring
    } </dev/null >"$chroot.log" 2>&1 || { tail -n 5 "$chroot.log" >&2; die "apt-get could not install it."; }
}

mirror() {
    local own
    # where this machine, if it is a Debian, gets its packages
    own=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 2>/dev/null |
        awk '$1 == "Debian" && $2 !~ /security/ { print $2; exit }') || true
    echo "${DEBIAN_MIRROR:-${own:-http://deb.debian.org/debian}}"
}

make_chroot() {
    get_debootstrap
    say "making a Debian ($suite) in $chroot: two minutes, once (log: $chroot.log); with QGIS it takes 3 GB of disk"
    rm -rf "$chroot" "$chroot.part"
    local script=/usr/share/debootstrap/scripts/$suite
    [ -e "$script" ] || script=/usr/share/debootstrap/scripts/sid # an older debootstrap
    debootstrap --variant=minbase --include=ca-certificates,git,python3 \
        "$suite" "$chroot.part" "$(mirror)" "$script" </dev/null >"$chroot.log" 2>&1 &
    local pid=$!
    while kill -0 "$pid" 2>/dev/null; do
        sleep 1
        [ $((SECONDS % 10)) -ne 0 ] || say "  debootstrap: $(tail -n 1 "$chroot.log" | cut -c 1-90)"
    done
    wait "$pid" ||
        { tail -n 5 "$chroot.log" >&2; die "debootstrap failed."; }
    # no service starts in there, and the packages are not kept twice
    printf '#!/bin/sh\nexit 101\n' >"$chroot.part/usr/sbin/policy-rc.d"
    chmod +x "$chroot.part/usr/sbin/policy-rc.d"
    echo 'APT::Keep-Downloaded-Packages "false";' >"$chroot.part/etc/apt/apt.conf.d/99isthmus"
    mv "$chroot.part" "$chroot"
}

# --- this machine's way to the network: proxy, mirrors, certificates ----------------------------------

lend() { # a file of this machine at a place in the chroot, for as long as this runs
    [ -f "$1" ] || return 0
    mkdir -p "$(dirname "$chroot$2")"
    [ -e "$chroot$2" ] || : >"$chroot$2"
    mount --bind "$1" "$chroot$2"
}

lend_network() {
    local file bundle=$chroot/etc/ssl/certs/isthmus.crt
    lend /etc/resolv.conf /etc/resolv.conf
    lend /etc/hosts /etc/hosts
    lend /etc/pip.conf /etc/pip.conf
    for file in "${PIP_CONFIG_FILE-}" "$user_home/.pip/pip.conf" "$user_home/.config/pip/pip.conf"; do
        lend "$file" /root/.config/pip/pip.conf
    done
    { apt-config dump 2>/dev/null || true; } |
        grep -E '^Acquire::(https?::(Proxy|CaInfo|Verify)|Check-)' >"$chroot/etc/apt/apt.conf.d/98host" || true
    # every authority that this machine trusts, its own files included
    for file in /etc/ssl/certs/ca-certificates.crt /etc/pki/tls/certs/ca-bundle.crt \
        "${SSL_CERT_FILE-}" "${PIP_CERT-}" "${REQUESTS_CA_BUNDLE-}" "${CURL_CA_BUNDLE-}"; do
        [ ! -f "$file" ] || cat "$file"
    done >"$bundle"
    environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 "TERM=${TERM-dumb}")
    for name in SSL_CERT_FILE PIP_CERT REQUESTS_CA_BUNDLE CURL_CA_BUNDLE; do
        environment+=("$name=/etc/ssl/certs/isthmus.crt")
    done
    for name in {http,https,no,all}_proxy {HTTP,HTTPS,NO,ALL}_PROXY \
        PIP_{INDEX_URL,EXTRA_INDEX_URL,TRUSTED_HOST,PROXY,DEFAULT_TIMEOUT}; do
        [ -z "${!name-}" ] || environment+=("$name=${!name}")
    done
}

# --- the command in it --------------------------------------------------------------------------------

put_checkout() {
    local checkout=$chroot/root/isthmus venv=$chroot/root/venv
    # the .venv of the last time stays, it belongs to this Debian
    [ ! -d "$checkout/.venv" ] || mv "$checkout/.venv" "$venv"
    rm -rf "$checkout"
    cp -r --no-preserve=ownership "$snapshot" "$checkout"
    [ ! -d "$venv" ] || mv "$venv" "$checkout/.venv"
}

[ -x "$chroot/usr/sbin/chroot" ] || make_chroot
mount --bind "$chroot" "$chroot" # a root of its own, so that in there a namespace can be made, too
lend_network
put_checkout
mount -t proc proc "$chroot/proc"
mount --rbind /dev "$chroot/dev"
# Qt asks the authorities of the system, and no variable
if ! diff -rq /usr/local/share/ca-certificates "$chroot/usr/local/share/ca-certificates" >/dev/null 2>&1; then
    cp -r /usr/local/share/ca-certificates "$chroot/usr/local/share/" 2>/dev/null || true
    chroot "$chroot" /usr/bin/env PATH=/usr/sbin:/usr/bin:/sbin:/bin update-ca-certificates >/dev/null 2>&1 || true
fi
say "on Debian $(cat "$chroot/etc/debian_version"): ./run $*"
chroot "$chroot" /usr/bin/env -i "${environment[@]}" \
    /bin/bash -c 'cd /root/isthmus && exec ./run "$@"' run "$@"
