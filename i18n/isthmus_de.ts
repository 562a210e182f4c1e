<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de">
 <context>
  <name>isthmus</name>
  <message>
   <source>,</source>
   <translation> </translation>
  </message>
  <message>
   <source>, or another layer of it: {}</source>
   <translation>, oder einen anderen Layer darin: {}</translation>
  </message>
  <message>
   <source>... and for {} more.</source>
   <translation>... und für {} weitere.</translation>
  </message>
  <message>
   <source>... and {} more; see the field status.</source>
   <translation>... und {} weitere; siehe das Feld status.</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Choosing tau&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Wahl von tau&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Cost&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Kosten&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Guarantee&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Was garantiert ist&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;How it works&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;So funktioniert es&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;How to read it&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;So liest man die Kurve&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Method&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Verfahren&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Methods&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Verfahren&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Problem&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Aufgabe&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Room&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Platz&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Size of the result&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Größe des Ergebnisses&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;To show one level&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Eine Stufe zeigen&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Units&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Einheiten&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;What cannot be helped&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Was sich nicht vermeiden lässt&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;What the map should be like&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Wie die Karte sein sollte&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;h3&gt;Which relevant edges&lt;/h3&gt;</source>
   <translation>&lt;h3&gt;Welche relevanten Kanten&lt;/h3&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;3 is a good start; smaller values cut more. &lt;i&gt;Detour trade-off curve&lt;/i&gt; shows what each value costs, and &lt;i&gt;Hierarchy of natural parts&lt;/i&gt; answers all of them at once.&lt;/p&gt;</source>
   <translation>&lt;p&gt;3 ist ein guter Anfang; kleinere Werte schneiden mehr. Die &lt;i&gt;Umwegkurve&lt;/i&gt; zeigt, was jeder Wert kostet, und die &lt;i&gt;Hierarchie natürlicher Teile&lt;/i&gt; beantwortet alle auf einmal.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;&lt;i&gt;Beware:&lt;/i&gt; with a free number of regions and boundaries between &lt;i&gt;all&lt;/i&gt; regions, neighbours of one class are merged for their boundary alone. Choose boundaries between &lt;i&gt;classes&lt;/i&gt;, raise the weight of the centre distance, or fix the number of regions, if you do not want that.&lt;/p&gt;</source>
   <translation>&lt;p&gt;&lt;i&gt;Vorsicht:&lt;/i&gt; Bei freier Anzahl der Regionen und Grenzen zwischen &lt;i&gt;allen&lt;/i&gt; Regionen werden Nachbarn derselben Klasse schon ihrer Grenze wegen vereinigt. Wenn Sie das nicht möchten, wählen Sie Grenzen zwischen &lt;i&gt;Klassen&lt;/i&gt;, erhöhen Sie das Gewicht der Entfernung vom Zentrum, oder geben Sie die Anzahl der Regionen vor.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;&lt;i&gt;MinSize&lt;/i&gt;, the optimal set, is the best choice: few edges, and the shape is kept. &lt;i&gt;Greedy&lt;/i&gt; (van Dijk and others 2013) needs more edges. &lt;i&gt;Proximity&lt;/i&gt; (Harrie and Sarjakoski 2002) and &lt;i&gt;None&lt;/i&gt; are there to compare with. With &lt;i&gt;Natural&lt;/i&gt; places (&lt;i&gt;Where a cut may lie&lt;/i&gt;) there are few edges, where people see parts meet; on the maps measured every diagonal kept the shape better.&lt;/p&gt;</source>
   <translation>&lt;p&gt;&lt;i&gt;MinSize&lt;/i&gt;, die optimale Menge, ist die beste Wahl: wenige Kanten, und die Form bleibt erhalten. &lt;i&gt;Greedy&lt;/i&gt; (van Dijk u. a. 2013) braucht mehr Kanten. &lt;i&gt;Proximity&lt;/i&gt; (Harrie und Sarjakoski 2002) und &lt;i&gt;None&lt;/i&gt; sind zum Vergleich da. Mit &lt;i&gt;natürlichen&lt;/i&gt; Stellen (&lt;i&gt;Wo ein Schnitt liegen darf&lt;/i&gt;) gibt es wenige Kanten, wo Menschen Teile aneinanderstoßen sehen; auf den gemessenen Karten hat jede Diagonale die Form besser erhalten.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;&lt;i&gt;greedy&lt;/i&gt;: the smallest area joins the neighbour that costs least; quick.&lt;br/&gt; &lt;i&gt;annealing&lt;/i&gt;: starts there and improves it, for a number of steps or seconds, then is heated again several times, of which the best is kept place by place. The same seed and number of steps give the same result. Parts of the map that hang together and have at most 20 areas are then solved by the exact method, where scipy is there, unless steps, seconds or a number of regions are given.&lt;br/&gt; &lt;i&gt;exact&lt;/i&gt;: a mixed-integer programme (HiGHS, through scipy) for small maps, with a lower bound that certifies how good the result is. Thirty areas take seconds, mostly; with hundreds the result is that of a short annealing, with a bound.&lt;/p&gt;</source>
   <translation>&lt;p&gt;&lt;i&gt;greedy&lt;/i&gt;: Die kleinste Fläche geht an den Nachbarn, bei dem es am wenigsten kostet; schnell.&lt;br/&gt; &lt;i&gt;annealing&lt;/i&gt; (simulierte Abkühlung): beginnt damit und verbessert es, eine Anzahl von Schritten oder Sekunden lang; dann wird mehrmals neu erhitzt und Ort für Ort das Beste behalten. Derselbe Startwert und dieselbe Anzahl von Schritten ergeben dasselbe. Teile der Karte, die zusammenhängen und höchstens 20 Flächen haben, löst danach die exakte Methode, wenn scipy da ist und weder Schritte noch Sekunden noch eine Anzahl von Regionen angegeben sind.&lt;br/&gt; &lt;i&gt;exact&lt;/i&gt;: ein gemischt-ganzzahliges Programm (HiGHS, über scipy) für kleine Karten, mit einer unteren Schranke, die belegt, wie gut das Ergebnis ist. Dreißig Flächen dauern meist Sekunden; bei Hunderten ist das Ergebnis das einer kurzen Abkühlung, mit Schranke.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Aggregates the areas of a land-cover map for a smaller scale: every area is given to a region, and every region is contiguous, at least as large as its class demands, and has the class of at least one of its areas. Among all ways to do so the tool looks for one of least cost.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Fasst die Flächen einer Karte der Bodenbedeckung für einen kleineren Maßstab zusammen: Jede Fläche kommt zu einer Region, und jede Region hängt zusammen, ist mindestens so groß, wie es ihre Klasse verlangt, und hat die Klasse wenigstens einer ihrer Flächen. Unter allen Möglichkeiten dafür sucht das Werkzeug eine mit den geringsten Kosten.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;All lines outside the region keep their direction and shape, and their scale changes smoothly. What holds a country together are not its outlines alone: east and west coast must know of each other. So the tool adds &lt;i&gt;relevant edges&lt;/i&gt;, diagonals between points that are close to each other though the way along the outline is long, and keeps these as well. By default it finds the smallest set of them by itself, the cuts of the tool &lt;i&gt;Partition polygons at bottlenecks&lt;/i&gt;. All features are solved together: islands move with their mainland, and points that lines or polygons share stay together. The whole frame of the map, land and sea, is triangulated, and the map is linear on each triangle; land is stiffer than sea. Large maps are solved on a coarse triangulation of about 3,000 points and the outline of the region, and the detail is put back point by point.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Alle Linien außerhalb der Region behalten Richtung und Form, und ihr Maßstab ändert sich stetig. Ein Land wird nicht nur von seinen Umrissen zusammengehalten: Ost- und Westküste müssen voneinander wissen. Deshalb fügt das Werkzeug &lt;i&gt;relevante Kanten&lt;/i&gt; hinzu, Diagonalen zwischen Punkten, die nah beieinander liegen, obwohl der Weg am Umriss entlang weit ist, und erhält auch diese. Ohne weitere Angabe findet es selbst die kleinste Menge davon: die Schnitte des Werkzeugs &lt;i&gt;Polygone an Engstellen zerlegen&lt;/i&gt;. Alle Objekte werden gemeinsam gelöst: Inseln bewegen sich mit ihrem Festland, und Punkte, die Linien oder Polygone gemeinsam haben, bleiben zusammen. Der ganze Kartenrahmen, Land und Meer, wird trianguliert, und die Abbildung ist in jedem Dreieck linear; Land ist steifer als Meer. Große Karten werden auf einer groben Triangulation von etwa 3.000 Punkten und dem Umriss der Region gelöst; die Einzelheiten werden dann Punkt für Punkt wieder eingesetzt.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Areas on an island that is too small for any of their classes, and areas without a class, stay as they are, with the reason in &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Flächen auf einer Insel, die für jede ihrer Klassen zu klein ist, und Flächen ohne Klasse bleiben, wie sie sind; der Grund steht in &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;At each tau, the way along the outline and the cuts that are left is at most tau times as long as each possible cut. For a polygon without holes the persistences are exact, and at the smallest tau no solution has fewer cuts. With holes the persistences are upper bounds, and cuts that connect holes stay. No vertex is moved, and none is added unless you ask for it. What cannot be split passes through unchanged, with the reason in the field &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Für jedes tau ist der Weg am Umriss und an den übrigen Schnitten entlang höchstens tau-mal so lang wie jeder mögliche Schnitt. Für Polygone ohne Löcher sind die Persistenzen exakt, und beim kleinsten tau kommt keine Lösung mit weniger Schnitten aus. Mit Löchern sind die Persistenzen obere Schranken, und Schnitte, die Löcher anschließen, bleiben. Kein Stützpunkt wird verschoben, und hinzugefügt wird einer nur, wenn Sie es verlangen. Was sich nicht zerlegen lässt, wird unverändert ausgegeben; der Grund steht im Feld &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Cuts lie at &lt;i&gt;natural&lt;/i&gt; places only: where the outline is concave and the polygon opens up beside the cut, as people see parts, and where no side is smaller than &lt;i&gt;Smallest part&lt;/i&gt;. Lengths of the outline are then measured without the detail that is much smaller. Choose &lt;i&gt;Any&lt;/i&gt; and 0 for the problem of the paper, where every diagonal counts; detours then grow with the detail of the outline, and tau should be 4 or more.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Schnitte liegen nur an &lt;i&gt;natürlichen&lt;/i&gt; Stellen: wo der Umriss einspringt und sich das Polygon neben dem Schnitt weitet, so wie Menschen Teile sehen, und wo keine Seite kleiner ist als &lt;i&gt;Kleinster Teil&lt;/i&gt;. Längen am Umriss werden dann ohne die Einzelheiten gemessen, die viel kleiner sind. Wählen Sie &lt;i&gt;Any&lt;/i&gt; und 0 für die Aufgabe des Artikels, in der jede Diagonale zählt; dann wachsen die Umwege mit der Genauigkeit des Umrisses, und tau sollte mindestens 4 sein.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Cuts polygons at their bottlenecks as far as a budget allows: at most so many cuts, or so much length or weight of cuts, for each feature. Instead of guessing tau, say "ten cuts".&lt;/p&gt;</source>
   <translation>&lt;p&gt;Zerlegt Polygone an ihren Engstellen, so weit ein Budget reicht: höchstens so viele Schnitte, oder so viel Länge oder Gewicht der Schnitte, für jedes Objekt. Statt tau zu raten, sagen Sie „zehn Schnitte“.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Cuts polygons at their isthmuses, straits and necks into natural parts: a peninsula from its continent, a bay from its sea.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Zerlegt Polygone an Landengen, Meerengen und anderen Engstellen in natürliche Teile: eine Halbinsel von ihrem Kontinent, eine Bucht von ihrem Meer.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Cuts polygons once, for every &lt;i&gt;largest detour&lt;/i&gt; (tau) from the smallest one on, and for every number of parts: bays within seas, and seas within the ocean.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Zerlegt Polygone ein einziges Mal für jeden &lt;i&gt;größten Umweg&lt;/i&gt; (tau) vom kleinsten an und für jede Anzahl von Teilen: Buchten in Meeren und Meere im Ozean.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Each part of each level is written once. A large body that loses a thousand small parts comes a thousand times: where there are so many cuts, as with PLACES = Any, give a number of parts or a larger tau.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Jeder Teil jeder Stufe wird einmal geschrieben. Ein großer Körper, der tausend kleine Teile verliert, kommt tausendmal vor: Wo es so viele Schnitte gibt, wie bei PLACES = Any, geben Sie eine Anzahl von Teilen oder ein größeres tau an.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Enlarges a region of a map and keeps the shape of the rest, as far as that is possible: a map in which one country, city or coast is larger, and all around it is still to be recognised.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Vergrößert eine Region einer Karte und erhält die Form des Übrigen, soweit das möglich ist: eine Karte, auf der ein Land, eine Stadt oder eine Küste größer und alles ringsum noch wiederzuerkennen ist.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;For polygons without holes the answer is exact for &lt;i&gt;MinSize&lt;/i&gt;. For &lt;i&gt;MinLength&lt;/i&gt; and &lt;i&gt;MinWeight&lt;/i&gt; it is so where each trial could be proven; where not, the tool says so. With holes it is the best that the tool finds. Holes must be connected by cuts, which count. A feature whose holes alone need more than the budget passes through unchanged; its status tells the least budget possible.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Für Polygone ohne Löcher ist die Antwort bei &lt;i&gt;MinSize&lt;/i&gt; exakt. Bei &lt;i&gt;MinLength&lt;/i&gt; und &lt;i&gt;MinWeight&lt;/i&gt; ist sie es, wo sich jeder Versuch beweisen ließ; wo nicht, sagt es das Werkzeug. Mit Löchern ist es das Beste, was das Werkzeug findet. Löcher müssen durch Schnitte angeschlossen werden, und diese zählen mit. Ein Objekt, dessen Löcher allein mehr als das Budget brauchen, wird unverändert ausgegeben; sein Status nennt das kleinste mögliche Budget.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Go through the curve from large tau to small. A step where the detour falls a lot for one more cut has found a real neck; then follows a long stretch where nothing changes. Where steps come thick and fast, the cuts no longer fall on necks but nibble at every bay. Good values of tau lie at the end of a long stretch.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Gehen Sie die Kurve von großem zu kleinem tau durch. Eine Stufe, an der der Umweg für einen weiteren Schnitt stark fällt, hat eine wirkliche Engstelle gefunden; dann folgt eine lange Strecke, auf der sich nichts ändert. Wo die Stufen dicht aufeinander folgen, liegen die Schnitte nicht mehr an Engstellen, sondern nagen an jeder Bucht. Gute Werte von tau liegen am Ende einer langen Strecke.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;It begins with the fewest cuts at the smallest tau, as &lt;i&gt;Partition polygons at bottlenecks&lt;/i&gt; finds them, and takes cuts away one by one, always the one that is needed least: whose loss leaves the smallest largest detour. That detour is the &lt;i&gt;persistence&lt;/i&gt; of the cut: up to this tau it is needed. So the parts are nested; for a single tau the fewest cuts may be one less here and there.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Es beginnt mit den wenigsten Schnitten beim kleinsten tau, wie &lt;i&gt;Polygone an Engstellen zerlegen&lt;/i&gt; sie findet, und nimmt einen Schnitt nach dem anderen weg, immer den entbehrlichsten: den, ohne den der größte Umweg am kleinsten bleibt. Dieser Umweg ist die &lt;i&gt;Persistenz&lt;/i&gt; des Schnitts: Bis zu diesem tau wird er gebraucht. So sind die Teile ineinander geschachtelt; für ein einzelnes tau können hier und da auch einmal ein Schnitt weniger genügen.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;J.-H. Haunert and A. Wolff, Area aggregation in map generalisation by mixed-integer programming, IJGIS 24(12), 2010.&lt;/p&gt;</source>
   <translation>&lt;p&gt;J.-H. Haunert und A. Wolff, Area aggregation in map generalisation by mixed-integer programming, IJGIS 24(12), 2010.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;J.-H. Haunert and L. Sering, Drawing Road Networks with Focus Regions, 2011; relevant edges: J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, section 5.1; steps that turn no triangle: J. Smith and S. Schaefer, Bijective Parameterization with Free Boundaries, 2015; detail without a fold: H. Shen and others, Progressive Embedding, 2019.&lt;/p&gt;</source>
   <translation>&lt;p&gt;J.-H. Haunert und L. Sering, Drawing Road Networks with Focus Regions, 2011; relevante Kanten: J.-H. Haunert und W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, Abschnitt 5.1; Schritte, die kein Dreieck umklappen: J. Smith und S. Schaefer, Bijective Parameterization with Free Boundaries, 2015; Einzelheiten ohne Faltung: H. Shen u. a., Progressive Embedding, 2019.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, section 5.2.&lt;/p&gt;</source>
   <translation>&lt;p&gt;J.-H. Haunert und W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, Abschnitt 5.2.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016.&lt;/p&gt;</source>
   <translation>&lt;p&gt;J.-H. Haunert und W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Lengths and areas are in the units of the layer; if its coordinates are degrees, they are metres and square metres on the ellipsoid. The results stay in the CRS of the layer.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Längen und Flächen sind in den Einheiten des Layers; sind seine Koordinaten Grad, dann in Metern und Quadratmetern auf dem Ellipsoid. Die Ergebnisse bleiben im KBS des Layers.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Lengths and areas are in the units of the layer; if its coordinates are degrees, they are metres and square metres on the ellipsoid.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Längen und Flächen sind in den Einheiten des Layers; sind seine Koordinaten Grad, dann in Metern und Quadratmetern auf dem Ellipsoid.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Measured are the diagonals of a Delaunay triangulation of the polygon (in the Mercator projection, if its coordinates are degrees) where a cut may lie, and the cuts are chosen from them. In the result the way along the outline and the cuts is at most tau times as long as each diagonal. For a polygon without holes no solution has fewer cuts. &lt;i&gt;MinLength&lt;/i&gt; and &lt;i&gt;MinWeight&lt;/i&gt; come with a proven lower bound of the cost; the search ends where the gap to it is as small as you ask for, or after nine minutes for each polygon on average. Holes are first joined by shortest cuts; what follows is a good solution, not always the best, and the lower bound is that of the polygon opened along these cuts.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Gemessen werden die Diagonalen einer Delaunay-Triangulation des Polygons (in der Mercatorprojektion, wenn seine Koordinaten Grad sind), wo ein Schnitt liegen darf, und aus ihnen werden die Schnitte gewählt. Im Ergebnis ist der Weg am Umriss und an den Schnitten entlang höchstens tau-mal so lang wie jede Diagonale. Für ein Polygon ohne Löcher kommt keine Lösung mit weniger Schnitten aus. Zu &lt;i&gt;MinLength&lt;/i&gt; und &lt;i&gt;MinWeight&lt;/i&gt; gehört eine bewiesene untere Schranke der Kosten; die Suche endet, sobald der Abstand zu ihr so klein ist wie verlangt, oder nach durchschnittlich neun Minuten je Polygon. Löcher werden zuerst durch kürzeste Schnitte angeschlossen; was folgt, ist eine gute, nicht immer die beste Lösung, und die untere Schranke ist die des Polygons, das an diesen Schnitten geöffnet ist.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Multipart features are split part by part. What cannot be split (invalid geometry, for one) passes through unchanged, with the reason in the field &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Mehrteilige Objekte werden Teil für Teil zerlegt. Was sich nicht zerlegen lässt (etwa eine ungültige Geometrie), wird unverändert ausgegeben; der Grund steht im Feld &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Run &lt;i&gt;Aggregate areas&lt;/i&gt; with the pieces next: pieces of one area that end in one region are merged again.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Führen Sie danach &lt;i&gt;Flächen zusammenfassen&lt;/i&gt; mit den Stücken aus: Stücke einer Fläche, die in derselben Region enden, werden wieder vereinigt.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Shows, for each feature, what every value of tau costs: how many cuts, or how much length or weight, &lt;i&gt;Partition polygons at bottlenecks&lt;/i&gt; would need for it. Take a value from the report as its tau, or a number of cuts as the budget of &lt;i&gt;Partition polygons within a budget&lt;/i&gt;.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Zeigt für jedes Objekt, was jeder Wert von tau kostet: wie viele Schnitte, oder wie viel Länge oder Gewicht, &lt;i&gt;Polygone an Engstellen zerlegen&lt;/i&gt; dafür braucht. Nehmen Sie einen Wert aus dem Bericht als tau, oder eine Anzahl von Schnitten als Budget für &lt;i&gt;Polygone mit einem Budget zerlegen&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Splits the areas of a land-cover map at their bottlenecks, so that &lt;i&gt;Aggregate areas&lt;/i&gt; can give the parts of one area to different regions. Less then has to change its class, and the regions become more compact.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Zerlegt die Flächen einer Karte der Bodenbedeckung an ihren Engstellen, damit &lt;i&gt;Flächen zusammenfassen&lt;/i&gt; die Teile einer Fläche verschiedenen Regionen geben kann. Dann muss weniger seine Klasse wechseln, und die Regionen werden kompakter.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Takes the pieces of &lt;i&gt;Prepare areas for aggregation&lt;/i&gt;, too: pieces of one area that end in one region are merged again.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Nimmt auch die Stücke von &lt;i&gt;Flächen zum Zusammenfassen vorbereiten&lt;/i&gt;: Stücke einer Fläche, die in derselben Region enden, werden wieder vereinigt.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The areas should fill the map without overlaps and gaps; what is found of these is counted and reported. Vertices of neighbours need not match: a vertex of one may lie inside an edge of the other. No vertex is moved, and none is added unless you ask for it: then neighbours get it too. So what neighbours share they still share. An area that cannot be cut (invalid, for one) passes through in one piece, with the reason in &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Flächen sollen die Karte ohne Überlappungen und Lücken füllen; was davon gefunden wird, wird gezählt und gemeldet. Die Stützpunkte von Nachbarn müssen nicht übereinstimmen: Ein Stützpunkt des einen darf in einer Kante des anderen liegen. Kein Stützpunkt wird verschoben, und hinzugefügt wird einer nur, wenn Sie es verlangen: dann bekommen ihn auch die Nachbarn. Was Nachbarn gemeinsam haben, haben sie so weiterhin gemeinsam. Eine Fläche, die sich nicht zerlegen lässt (etwa weil sie ungültig ist), wird in einem Stück ausgegeben; der Grund steht in &lt;i&gt;status&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The dual problem of J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, section 2.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die duale Aufgabe zu J.-H. Haunert und W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, Abschnitt 2.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The parts of all levels lie on top of each other. The filter &lt;i&gt;from_tau &amp;lt;= 3 AND 3 &amp;lt; to_tau&lt;/i&gt; shows the partition at tau = 3, and &lt;i&gt;persistence &amp;gt; 3&lt;/i&gt; its cuts. Parts that stay for ever have a to_tau of 1,000,000,000, and cuts that only connect a hole have this persistence.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Teile aller Stufen liegen übereinander. Der Filter &lt;i&gt;from_tau &amp;lt;= 3 AND 3 &amp;lt; to_tau&lt;/i&gt; zeigt die Zerlegung bei tau = 3, und &lt;i&gt;persistence &amp;gt; 3&lt;/i&gt; ihre Schnitte. Teile, die immer bleiben, haben ein to_tau von 1.000.000.000, und Schnitte, die nur ein Loch anschließen, haben diese Persistenz.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The region has exactly the scale asked for, or nothing is written and the tool says why. No triangle is turned over: no lines cross that did not cross before, and polygons stay valid. Where the end or a point of one line lies on another without being a point of it, or lines cross, the line gets a point there, so that they stay together. This is tested exactly, where the points will be, before anything is written. Squares, as rasters have them, stay convex besides, unless the log tells how many do not. The numbers tell how much the triangles of the polygons are distorted: the change of angles that half, and 95 %, of the area do not exceed.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Region hat genau die verlangte Vergrößerung, oder es wird nichts geschrieben und das Werkzeug sagt, warum. Kein Dreieck wird umgeklappt: Es kreuzen sich keine Linien, die sich nicht schon vorher kreuzten, und Polygone bleiben gültig. Wo das Ende oder ein Punkt einer Linie auf einer anderen liegt, ohne ein Punkt von ihr zu sein, oder wo sich Linien kreuzen, bekommt die Linie dort einen Punkt, damit sie zusammenbleiben. Das wird exakt geprüft, dort, wo die Punkte liegen werden, bevor etwas geschrieben wird. Auch Quadrate, wie Raster sie haben, bleiben konvex, es sei denn, das Protokoll sagt, wie viele nicht. Die Zahlen sagen, wie stark die Dreiecke der Polygone verzerrt sind: die Änderung der Winkel, die auf der Hälfte und auf 95 % der Fläche nicht überschritten wird.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The region may be a feature of the map: choose the same layer, and tick &lt;i&gt;Selected features only&lt;/i&gt;. A map in degrees is solved in an equidistant cylindrical projection, true at its middle latitude, and comes back in degrees; a projected CRS shows better what you get.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Region kann ein Objekt der Karte sein: Wählen Sie denselben Layer und &lt;i&gt;Nur gewählte Objekte&lt;/i&gt;. Eine Karte in Grad wird in einer abstandstreuen Zylinderprojektion gelöst, die in ihrer mittleren Breite längentreu ist, und kommt in Grad zurück; ein projiziertes KBS zeigt besser, was Sie bekommen.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The report marks the five steps that pay off most: the largest fall of the detour (on a logarithmic scale) for what they cost more.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Der Bericht hebt die fünf Stufen hervor, die sich am meisten lohnen: an denen der Umweg (auf logarithmischer Skala) im Verhältnis zu den Mehrkosten am stärksten sinkt.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The style of the parts shows the level of the project variable &lt;i&gt;isthmus_tau&lt;/i&gt; (Project, Properties, Variables), or that of tau = 3. For a slider on it, enter this line in the Python console:&lt;/p&gt;</source>
   <translation>&lt;p&gt;Der Stil der Teile zeigt die Stufe der Projektvariablen &lt;i&gt;isthmus_tau&lt;/i&gt; (Projekt, Eigenschaften, Variablen), oder die von tau = 3. Für einen Schieberegler dafür geben Sie diese Zeile in der Python-Konsole ein:&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The sum of three parts, each with a weight:&lt;br/&gt; &lt;i&gt;class change&lt;/i&gt;: size in square metres times the distance of the two classes;&lt;br/&gt; &lt;i&gt;boundary length&lt;/i&gt;: metres between regions, or only between regions of different class;&lt;br/&gt; &lt;i&gt;centre distance&lt;/i&gt;: size times the root mean square distance, in metres, of the points of an area from the centroid of its region's core, the area that gives the region its class. Haunert and Wolff measure from centroid to centroid; then the cost would depend on how an area is cut in pieces.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Summe dreier Teile, jeder mit einem Gewicht:&lt;br/&gt; &lt;i&gt;Klassenwechsel&lt;/i&gt;: Größe in Quadratmetern mal Abstand der beiden Klassen;&lt;br/&gt; &lt;i&gt;Grenzlänge&lt;/i&gt;: Meter zwischen Regionen, oder nur zwischen Regionen verschiedener Klasse;&lt;br/&gt; &lt;i&gt;Entfernung vom Zentrum&lt;/i&gt;: Größe mal quadratisches Mittel der Entfernung, in Metern, der Punkte einer Fläche vom Schwerpunkt des Kerns ihrer Region, also der Fläche, die der Region ihre Klasse gibt. Haunert und Wolff messen von Schwerpunkt zu Schwerpunkt; dann hingen die Kosten davon ab, wie eine Fläche in Stücke zerlegt ist.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The table has one row for each step: from its tau up to that of the step before, its solution is the cheapest. The steps are exact for polygons without holes and &lt;i&gt;MinSize&lt;/i&gt;. &lt;i&gt;MinLength&lt;/i&gt; and &lt;i&gt;MinWeight&lt;/i&gt; have very many steps and take longer. Lengths are in the units of the layer; if its coordinates are degrees, they are metres.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Die Tabelle hat eine Zeile für jede Stufe: Von ihrem tau bis zu dem der vorigen ist ihre Lösung die günstigste. Die Stufen sind für Polygone ohne Löcher und &lt;i&gt;MinSize&lt;/i&gt; exakt. &lt;i&gt;MinLength&lt;/i&gt; und &lt;i&gt;MinWeight&lt;/i&gt; haben sehr viele Stufen und dauern länger. Längen sind in den Einheiten des Layers; sind seine Koordinaten Grad, dann in Metern.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;The tool finds the smallest detour that is achievable within the budget, and writes it to the field &lt;i&gt;tau&lt;/i&gt; of the parts. It is an achieved value: with any smaller one the budget would be exceeded. What a detour is, the tool &lt;i&gt;Partition polygons at bottlenecks&lt;/i&gt; explains.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Das Werkzeug findet den kleinsten Umweg, der mit dem Budget erreichbar ist, und schreibt ihn in das Feld &lt;i&gt;tau&lt;/i&gt; der Teile. Es ist ein erreichter Wert: Mit jedem kleineren würde das Budget überschritten. Was ein Umweg ist, erklärt das Werkzeug &lt;i&gt;Polygone an Engstellen zerlegen&lt;/i&gt;.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;Three sets of weights have names: &lt;i&gt;balanced&lt;/i&gt;; &lt;i&gt;keep classes&lt;/i&gt;, with a quarter of its weights for boundary and centre; &lt;i&gt;compact&lt;/i&gt;, with twice its weight for boundary and four times that for centre. A weight that is given wins. They are good for 40 hectares (1:250,000); for another minimum size multiply that of the boundary length by the square root of the ratio, and divide that of the centre distance by it.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Drei Sätze von Gewichten haben Namen: &lt;i&gt;balanced&lt;/i&gt; (ausgewogen); &lt;i&gt;keep classes&lt;/i&gt; (Klassen erhalten), mit einem Viertel von dessen Gewichten für Grenze und Zentrum; &lt;i&gt;compact&lt;/i&gt; (kompakt), mit dem Doppelten für die Grenze und dem Vierfachen für das Zentrum. Ein Gewicht, das Sie angeben, geht vor. Sie passen für 40 Hektar (1:250.000); für eine andere Mindestgröße multiplizieren Sie das der Grenzlänge mit der Wurzel aus dem Verhältnis und teilen das der Entfernung vom Zentrum durch sie.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;What the region gains, the rest has to give, or the map becomes larger: by &lt;i&gt;Growth of the map&lt;/i&gt; at most, and by no more than it needs so that what is around the region bends as little for a small region as for a large one, at any scale. With no growth at all the extent is kept, and what lies between the region and the edge gets thin.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Was die Region gewinnt, muss das Übrige hergeben, oder die Karte wird größer: höchstens um das &lt;i&gt;Wachstum der Karte&lt;/i&gt;, und nicht mehr als nötig, damit sich das, was um die Region liegt, bei einer kleinen Region so wenig verbiegt wie bei einer großen, bei jeder Vergrößerung. Ganz ohne Wachstum bleibt die Ausdehnung, und was zwischen der Region und dem Rand liegt, wird schmal.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;You set one number, the &lt;i&gt;largest detour&lt;/i&gt; (tau). Two points on opposite sides of a neck are close to each other, but the way along the outline is long: many times longer than the straight line. The tool finds the smallest number of cuts that leaves no place with a detour above tau. Cuts join existing vertices: no vertex is moved, none is added unless you ask for it, and the parts fit together exactly.&lt;/p&gt;</source>
   <translation>&lt;p&gt;Sie geben eine einzige Zahl vor, den &lt;i&gt;größten Umweg&lt;/i&gt; (tau). Zwei Punkte auf den beiden Seiten einer Engstelle liegen nah beieinander, aber der Weg am Umriss entlang ist weit: viele Male so lang wie die gerade Linie. Das Werkzeug findet die kleinste Anzahl von Schnitten, nach denen es nirgends einen größeren Umweg als tau gibt. Schnitte verbinden vorhandene Stützpunkte: Keiner wird verschoben, hinzugefügt wird einer nur, wenn Sie es verlangen, und die Teile passen genau aneinander.&lt;/p&gt;</translation>
  </message>
  <message>
   <source>&lt;p&gt;from qgis.PyQt.QtWidgets import QSlider; slider = QSlider(); slider.setRange(10, 300); slider.valueChanged.connect(lambda value: (QgsExpressionContextUtils.setProjectVariable(QgsProject.instance(), "isthmus_tau", value / 10), iface.mapCanvas().refreshAllLayers())); slider.show()&lt;/p&gt;</source>
   <translation>&lt;p&gt;from qgis.PyQt.QtWidgets import QSlider; slider = QSlider(); slider.setRange(10, 300); slider.valueChanged.connect(lambda value: (QgsExpressionContextUtils.setProjectVariable(QgsProject.instance(), "isthmus_tau", value / 10), iface.mapCanvas().refreshAllLayers())); slider.show()&lt;/p&gt;</translation>
  </message>
  <message>
   <source>A GeoPackage with one layer for each further layer, by its name. It is written anew.</source>
   <translation>Ein GeoPackage mit einem Layer für jeden weiteren Layer, unter dessen Namen. Es wird neu geschrieben.</translation>
  </message>
  <message>
   <source>A feature of {} could not be written: {}</source>
   <translation>Ein Objekt aus {} konnte nicht geschrieben werden: {}</translation>
  </message>
  <message>
   <source>A long flat stretch means that nothing more is to be gained for a while: good values of tau lie at its left end. Red dots mark the steps that pay off most, the largest fall of the detour (on a logarithmic scale) for what they cost more.</source>
   <translation>Ein langes flaches Stück heißt, dass eine Weile lang nichts mehr zu gewinnen ist: Gute Werte von tau liegen an seinem linken Ende. Rote Punkte zeigen die Stufen, die sich am meisten lohnen: Dort sinkt der Umweg (logarithmisch) im Verhältnis zu den Mehrkosten am stärksten.</translation>
  </message>
  <message>
   <source>A page with a plot for each feature and the steps that pay off most.</source>
   <translation>Eine Seite mit einem Diagramm für jedes Objekt und den Stufen, die sich am meisten lohnen.</translation>
  </message>
  <message>
   <source>A page with the cost by part, the classes before and after, and the areas above half of the minimum size that lost their class.</source>
   <translation>Eine Seite mit den Kosten nach Bestandteilen, den Klassen vorher und nachher und den Flächen über der halben Mindestgröße, die ihre Klasse verloren haben.</translation>
  </message>
  <message>
   <source>A result{} could not be written (is the disk full, or a value too long or unknown to the format?): {}</source>
   <translation>Ein Ergebnis{} konnte nicht geschrieben werden (ist der Datenträger voll, oder ein Wert zu lang oder dem Format unbekannt?): {}</translation>
  </message>
  <message>
   <source>A result{} could not be written: it is of the type {}, and the layer takes {} only. Leave it out of the input, or write to a GeoPackage.</source>
   <translation>Ein Ergebnis{} konnte nicht geschrieben werden: Es ist vom Typ {}, und der Layer nimmt nur {}. Lassen Sie es aus der Eingabe weg, oder schreiben Sie in ein GeoPackage.</translation>
  </message>
  <message>
   <source>A table of class distances (DISTANCES) is needed, or another way to measure them.</source>
   <translation>Es fehlt eine Tabelle der Klassenabstände (DISTANCES); sonst wählen Sie eine andere Art, sie zu messen.</translation>
  </message>
  <message>
   <source>A table of neighbouring pieces a and b, the length of their shared boundary in metres, and virtual: 1 for a cut between two pieces of one area.</source>
   <translation>Eine Tabelle benachbarter Stücke a und b, mit der Länge ihrer gemeinsamen Grenze in Metern und virtual: 1 für einen Schnitt zwischen zwei Stücken einer Fläche.</translation>
  </message>
  <message>
   <source>A table with a row for each step: source (id of the feature), tau (the least dilation achievable at this cost), cuts, length, cost, largest_part_share (the area of the largest part in that of the feature).</source>
   <translation>Eine Tabelle mit einer Zeile für jede Stufe: source (ID des Objekts), tau (der kleinste Umweg, der zu diesen Kosten erreichbar ist), cuts, length, cost, largest_part_share (Anteil des größten Teils an der Fläche des Objekts).</translation>
  </message>
  <message>
   <source>A table with the fields class and threshold (square metres). A class whose threshold is empty may not appear in the result.</source>
   <translation>Eine Tabelle mit den Feldern class und threshold (Quadratmeter). Eine Klasse ohne threshold darf im Ergebnis nicht vorkommen.</translation>
  </message>
  <message>
   <source>A table with the fields from, to and distance. Where only one direction is listed, it is used for both.</source>
   <translation>Eine Tabelle mit den Feldern from, to und distance. Steht nur eine Richtung darin, gilt sie für beide.</translation>
  </message>
  <message>
   <source>Advanced.</source>
   <translation>Erweitert.</translation>
  </message>
  <message>
   <source>Aggregate areas</source>
   <translation>Flächen zusammenfassen</translation>
  </message>
  <message>
   <source>Aggregating {} ({})</source>
   <translation>Zusammenfassen: {} ({})</translation>
  </message>
  <message>
   <source>Aggregation of {}</source>
   <translation>Flächenaggregation: {}</translation>
  </message>
  <message>
   <source>All candidate diagonals</source>
   <translation>Alle möglichen Schnitte</translation>
  </message>
  <message>
   <source>All features and fields of the map.</source>
   <translation>Alle Objekte und Felder der Karte.</translation>
  </message>
  <message>
   <source>All fields of the areas, and area_id (the id of the area), piece (a number for each piece), size (in square metres) and status (empty, or why an area was not cut).</source>
   <translation>Alle Felder der Flächen, dazu area_id (ID der Fläche), piece (eine Nummer für jedes Stück), size (in Quadratmetern) und status (leer, oder warum eine Fläche nicht zerlegt wurde).</translation>
  </message>
  <message>
   <source>All fields of the polygons, and part (1 for the largest of a feature), parts (their number), status (empty, or why a polygon was not cut), cost and gap of the solution of the feature (gap in per cent), and source (the id of the feature), tau.</source>
   <translation>Alle Felder der Polygone, dazu part (1 für den größten Teil eines Objekts), parts (ihre Anzahl), status (leer, oder warum ein Polygon nicht zerlegt wurde), cost und gap der Lösung des Objekts (gap in Prozent), source (ID des Objekts) und tau.</translation>
  </message>
  <message>
   <source>All fields of the polygons, and part (1 for the largest of a feature), parts (their number), status (empty, or why a polygon was not cut), cost and gap of the solution of the feature (gap in per cent), and source (the id of the feature).</source>
   <translation>Alle Felder der Polygone, dazu part (1 für den größten Teil eines Objekts), parts (ihre Anzahl), status (leer, oder warum ein Polygon nicht zerlegt wurde), cost und gap der Lösung des Objekts (gap in Prozent) und source (ID des Objekts).</translation>
  </message>
  <message>
   <source>An area that is large enough by itself is always the core of a region. The map then falls into parts that are solved one by one; the lower bound is that of solutions with this property.</source>
   <translation>Eine Fläche, die allein groß genug ist, ist immer Kern einer Region. Die Karte zerfällt dann in Teile, die einzeln gelöst werden; die untere Schranke gilt für Lösungen mit dieser Eigenschaft.</translation>
  </message>
  <message>
   <source>An expression for the weight of a possible cut, such as @length / @detour. It sees the line's geometry, @length, @detour, the fields of the polygon and, where you give lines to choose from, the fields of the line. Zero makes a cut free.</source>
   <translation>Ein Ausdruck für das Gewicht eines möglichen Schnitts, etwa @length / @detour. Er sieht die Geometrie der Linie, @length, @detour, die Felder des Polygons und, wo Sie Linien zur Auswahl geben, die Felder der Linie. Bei Null kostet ein Schnitt nichts.</translation>
  </message>
  <message>
   <source>Angular distortion, 95 % (degrees)</source>
   <translation>Winkelverzerrung, 95 % (Grad)</translation>
  </message>
  <message>
   <source>Another seed gives another result.</source>
   <translation>Ein anderer Startwert gibt ein anderes Ergebnis.</translation>
  </message>
  <message>
   <source>Any</source>
   <translation>Überall (Any)</translation>
  </message>
  <message>
   <source>Area aggregation</source>
   <translation>Flächenaggregation</translation>
  </message>
  <message>
   <source>Area upside down (%)</source>
   <translation>Umgeklappte Fläche (%)</translation>
  </message>
  <message>
   <source>Area {} is left as it is: {}.</source>
   <translation>Fläche {} bleibt, wie sie ist: {}.</translation>
  </message>
  <message>
   <source>Area {} was not cut: {}.</source>
   <translation>Fläche {} wurde nicht zerlegt: {}.</translation>
  </message>
  <message>
   <source>Areas</source>
   <translation>Flächen</translation>
  </message>
  <message>
   <source>Areas above half of the minimum size of their class, and how many of them lost it (by more than half of their size).</source>
   <translation>Flächen über der halben Mindestgröße ihrer Klasse, und wie viele von ihnen sie (mit mehr als der halben Fläche) verloren haben.</translation>
  </message>
  <message>
   <source>Areas above half of the minimum size that lost their class: {} of {}{}.</source>
   <translation>Flächen über der Hälfte der Mindestgröße, die ihre Klasse verloren haben: {} von {}{}.</translation>
  </message>
  <message>
   <source>Areas before, regions after, with their sizes in hectares.</source>
   <translation>Flächen vorher, Regionen nachher, mit ihrer Größe in Hektar.</translation>
  </message>
  <message>
   <source>Areas that fill a map, or the pieces of Prepare areas for aggregation.</source>
   <translation>Flächen, die eine Karte füllen, oder die Stücke von „Flächen zum Zusammenfassen vorbereiten“.</translation>
  </message>
  <message>
   <source>Areas with their regions</source>
   <translation>Flächen mit ihren Regionen</translation>
  </message>
  <message>
   <source>BSD</source>
   <translation>BSD</translation>
  </message>
  <message>
   <source>Before: every area a region of its own. The share is that of the cost after.</source>
   <translation>Vorher: jede Fläche als eigene Region. Der Anteil bezieht sich auf die Kosten nachher.</translation>
  </message>
  <message>
   <source>Beside another area, but with no boundary in common because of a gap or an overlap: {}, such as area {} beside area {}. Gaps may be too narrow to be seen. Close them first, by v.clean or Snap geometries to layer.</source>
   <translation>Neben einer anderen Fläche, aber wegen einer Lücke oder Überlappung ohne gemeinsame Grenze: {}, etwa Fläche {} neben Fläche {}. Lücken können so schmal sein, dass man sie nicht sieht. Bitte zuerst schließen, mit v.clean oder „Geometrien an Layer einrasten“.</translation>
  </message>
  <message>
   <source>Blocks, floor plans and generalised outlines often have no vertex opposite a neck. With this, a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite. Only those where a cut ends are added, with Z and M interpolated, and the parts of the levels without this cut do not have them. Neighbours in the layer do not get them.</source>
   <translation>Gebäudeblöcke, Grundrisse und generalisierte Umrisse haben gegenüber einer Engstelle oft keinen Stützpunkt. Hiermit darf ein Schnitt auch am Fußpunkt eines Lots enden, das von einem einspringenden Stützpunkt auf die Kante gegenüber gefällt ist. Nur die, an denen ein Schnitt endet, werden hinzugefügt, mit interpoliertem Z und M, und die Teile der Stufen ohne diesen Schnitt haben sie nicht. Nachbarn im Layer bekommen sie nicht.</translation>
  </message>
  <message>
   <source>Blocks, floor plans and generalised outlines often have no vertex opposite a neck. With this, a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite. Only those where a cut ends are added, with Z and M interpolated. Neighbours get the same vertices, so that shared boundaries stay shared.</source>
   <translation>Gebäudeblöcke, Grundrisse und generalisierte Umrisse haben gegenüber einer Engstelle oft keinen Stützpunkt. Hiermit darf ein Schnitt auch am Fußpunkt eines Lots enden, das von einem einspringenden Stützpunkt auf die Kante gegenüber gefällt ist. Nur die, an denen ein Schnitt endet, werden hinzugefügt, mit interpoliertem Z und M. Nachbarn bekommen dieselben Stützpunkte, damit gemeinsame Grenzen gemeinsam bleiben.</translation>
  </message>
  <message>
   <source>Blocks, floor plans and generalised outlines often have no vertex opposite a neck. With this, a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite. Only those where a cut ends are added, with Z and M interpolated; the rest of the outline stays as it is. Neighbours in the layer do not get them. No effect where you give lines to choose from.</source>
   <translation>Gebäudeblöcke, Grundrisse und generalisierte Umrisse haben gegenüber einer Engstelle oft keinen Stützpunkt. Hiermit darf ein Schnitt auch am Fußpunkt eines Lots enden, das von einem einspringenden Stützpunkt auf die Kante gegenüber gefällt ist. Nur die, an denen ein Schnitt endet, werden hinzugefügt, mit interpoliertem Z und M; der übrige Umriss bleibt, wie er ist. Nachbarn im Layer bekommen sie nicht. Ohne Wirkung, wo Sie Linien zur Auswahl geben.</translation>
  </message>
  <message>
   <source>Boundaries that count: of regions or of classes</source>
   <translation>Welche Grenzen zählen: von Regionen oder Klassen</translation>
  </message>
  <message>
   <source>Budget of a feature (cuts, length or weight)</source>
   <translation>Budget je Objekt (Schnitte, Länge oder Gewicht)</translation>
  </message>
  <message>
   <source>Cancel</source>
   <translation>Abbrechen</translation>
  </message>
  <message>
   <source>Cancelled: the results are not complete.</source>
   <translation>Abgebrochen: Die Ergebnisse sind nicht vollständig.</translation>
  </message>
  <message>
   <source>Candidate line {} was left out: {}.</source>
   <translation>Die Linie {} zur Auswahl wurde weggelassen: {}.</translation>
  </message>
  <message>
   <source>Carried layers</source>
   <translation>Mitgeführte Layer</translation>
  </message>
  <message>
   <source>Choose a layer, and find its cuts once. Then move the slider.</source>
   <translation>Wählen Sie einen Layer und lassen Sie seine Schnitte einmal suchen. Dann bewegen Sie den Regler.</translation>
  </message>
  <message>
   <source>Class field</source>
   <translation>Klassenfeld</translation>
  </message>
  <message>
   <source>Classes</source>
   <translation>Klassen</translation>
  </message>
  <message>
   <source>Classes that may not appear in the result, separated by commas.</source>
   <translation>Klassen, die im Ergebnis nicht vorkommen dürfen, durch Kommas getrennt.</translation>
  </message>
  <message>
   <source>Classes without any region: {}{}.</source>
   <translation>Klassen ohne Region: {}{}.</translation>
  </message>
  <message>
   <source>Copy the command</source>
   <translation>Befehl kopieren</translation>
  </message>
  <message>
   <source>Cost</source>
   <translation>Kosten</translation>
  </message>
  <message>
   <source>Cost of all solutions</source>
   <translation>Kosten aller Lösungen</translation>
  </message>
  <message>
   <source>Cost of boundary length</source>
   <translation>Kosten der Grenzlänge</translation>
  </message>
  <message>
   <source>Cost of centre distance</source>
   <translation>Kosten der Entfernung vom Zentrum</translation>
  </message>
  <message>
   <source>Cost of class change</source>
   <translation>Kosten des Klassenwechsels</translation>
  </message>
  <message>
   <source>Cost over tau</source>
   <translation>Kosten über tau</translation>
  </message>
  <message>
   <source>Cost {}: class change {}, boundary {}, centre distance {}. {}; {:.2f} % of the area changed its class.</source>
   <translation>Kosten {}: Klassenwechsel {}, Grenzen {}, Entfernung vom Zentrum {}. {}; {:.2f} % der Fläche haben die Klasse gewechselt.</translation>
  </message>
  <message>
   <source>Cuts</source>
   <translation>Schnitte</translation>
  </message>
  <message>
   <source>Cuts by persistence</source>
   <translation>Schnitte nach Persistenz</translation>
  </message>
  <message>
   <source>Cuts may end at new vertices on edges</source>
   <translation>Schnitte dürfen an neuen Stützpunkten enden</translation>
  </message>
  <message>
   <source>Cuts polygons at bottlenecks with at most so many cuts, or so much length of cuts.</source>
   <translation>Zerlegt Polygone an Engstellen mit höchstens so vielen Schnitten oder so viel Schnittlänge.</translation>
  </message>
  <message>
   <source>Cuts polygons at isthmuses, straits and necks into natural parts.</source>
   <translation>Zerlegt Polygone an Landengen, Meerengen und anderen Engstellen in natürliche Teile.</translation>
  </message>
  <message>
   <source>Cuts polygons into natural parts for every tau and every number of parts at once.</source>
   <translation>Zerlegt Polygone in natürliche Teile, für jedes tau und jede Anzahl von Teilen auf einmal.</translation>
  </message>
  <message>
   <source>Deformation</source>
   <translation>Deformation</translation>
  </message>
  <message>
   <source>Detour trade-off curve</source>
   <translation>Umwegkurve</translation>
  </message>
  <message>
   <source>Detour trade-off of {}</source>
   <translation>Umwegkurve: {}</translation>
  </message>
  <message>
   <source>Distance of classes</source>
   <translation>Abstand der Klassen</translation>
  </message>
  <message>
   <source>Each curve shows, for every value of tau, the least cost ({}) that keeps all detours within it ({}).</source>
   <translation>Jede Kurve zeigt für jeden Wert von tau die geringsten Kosten ({}), mit denen kein Umweg größer bleibt ({}).</translation>
  </message>
  <message>
   <source>Enlarge a region in context</source>
   <translation>Region im Zusammenhang vergrößern</translation>
  </message>
  <message>
   <source>Enlarges a region of a map and keeps the shape of the rest.</source>
   <translation>Vergrößert eine Region einer Karte und erhält die Form des Übrigen.</translation>
  </message>
  <message>
   <source>Every candidate, with its detour before any cut, its dilation in the solution, and its role: SELF is a cut; LEAF and ROOT tell on which side the way around lies.</source>
   <translation>Jeder mögliche Schnitt, mit seinem Umweg vor allen Schnitten (detour), dem Umweg, der in der Lösung bleibt (dilation), und seiner Rolle (role): SELF wird geschnitten; LEAF und ROOT sagen, auf welcher Seite der Weg herum liegt.</translation>
  </message>
  <message>
   <source>Every part of every level once, with all fields of the polygons, and part (its number in the feature, by level and size), parent (the part that it becomes a piece of; empty for those that stay), level (0 is the finest; that in which it comes up), from_tau and to_tau (it is there where from_tau &lt;= tau &lt; to_tau), source (the id of the feature) and status (empty, or why a polygon was not cut).</source>
   <translation>Jeder Teil jeder Stufe einmal, mit allen Feldern der Polygone, dazu part (seine Nummer im Objekt, nach Stufe und Größe), parent (der Teil, in dem er aufgeht; leer bei denen, die bleiben), level (0 ist die feinste Stufe; die, in der er entsteht), from_tau und to_tau (es gibt ihn, wo from_tau &lt;= tau &lt; to_tau), source (ID des Objekts) und status (leer, oder warum ein Polygon nicht zerlegt wurde).</translation>
  </message>
  <message>
   <source>Exact: large areas stay cores of their own</source>
   <translation>Exakt: Große Flächen bleiben eigene Kerne</translation>
  </message>
  <message>
   <source>Excluded classes</source>
   <translation>Ausgeschlossene Klassen</translation>
  </message>
  <message>
   <source>Feature {}</source>
   <translation>Objekt {}</translation>
  </message>
  <message>
   <source>Feature {} has a latitude beyond 90 degrees. Its coordinates are taken as those of a plane. Is the CRS of the layer right?</source>
   <translation>Objekt {} hat eine Breite jenseits von 90 Grad. Seine Koordinaten gelten als die einer Ebene. Stimmt das KBS des Layers?</translation>
  </message>
  <message>
   <source>Feature {} has no curve: {}.</source>
   <translation>Objekt {} hat keine Kurve: {}.</translation>
  </message>
  <message>
   <source>Feature {} of {} has no place in the CRS of the map ({}). Is the CRS of {} right?</source>
   <translation>Objekt {} von {} hat keinen Ort im KBS der Karte ({}). Stimmt das KBS von {}?</translation>
  </message>
  <message>
   <source>Feature {} was not cut: {}.</source>
   <translation>Objekt {} wurde nicht zerlegt: {}.</translation>
  </message>
  <message>
   <source>Feature {}: a smaller detour than {:.6g} may be possible within the budget, which could be neither shown nor ruled out.</source>
   <translation>Objekt {}: Ein kleinerer Umweg als {:.6g} ist mit dem Budget vielleicht möglich; das ließ sich weder zeigen noch ausschließen.</translation>
  </message>
  <message>
   <source>Feature {}: parts of it were left out: {}.</source>
   <translation>Objekt {}: Teile davon wurden weggelassen: {}.</translation>
  </message>
  <message>
   <source>Feature {}: the search ended at a gap of {:.3g} per cent between the cost and its proven lower bound, its limit of time or memory being reached.</source>
   <translation>Objekt {}: Die Suche endete bei einem Abstand von {:.3g} Prozent zwischen den Kosten und ihrer bewiesenen unteren Schranke, da die Grenze für Zeit oder Speicher erreicht war.</translation>
  </message>
  <message>
   <source>Fetch and install</source>
   <translation>Holen und installieren</translation>
  </message>
  <message>
   <source>Field with the area of a piece</source>
   <translation>Feld mit der Fläche eines Stücks</translation>
  </message>
  <message>
   <source>Fields of {}: {}.</source>
   <translation>Felder von {}: {}.</translation>
  </message>
  <message>
   <source>Find the cuts</source>
   <translation>Schnitte suchen</translation>
  </message>
  <message>
   <source>Finding shared boundaries</source>
   <translation>Suche gemeinsame Grenzen</translation>
  </message>
  <message>
   <source>Focus map</source>
   <translation>Fokuskarte</translation>
  </message>
  <message>
   <source>For MinLength and MinWeight, which are hard to solve exactly: how much more than the proven lower bound a solution may cost. 0 asks for a proof of optimality. MinSize is always optimal.</source>
   <translation>Für MinLength und MinWeight, die schwer exakt zu lösen sind: wie viel mehr als die bewiesene untere Schranke eine Lösung kosten darf. 0 verlangt einen Beweis der Optimalität. MinSize ist immer optimal.</translation>
  </message>
  <message>
   <source>For MinSize and MinLength. Natural: only where people see parts meet, at places where the outline is concave and the polygon opens up beside the cut; a few edges then do, but the shape is kept less well. Any: between any two vertices that a triangulation joins, as in the paper.</source>
   <translation>Für MinSize und MinLength. Natural (natürlich): nur wo Menschen Teile aneinanderstoßen sehen, an Stellen, wo der Umriss einspringt und sich das Polygon neben dem Schnitt weitet; dann genügen wenige Kanten, aber die Form bleibt weniger gut erhalten. Any (überall): zwischen je zwei Stützpunkten, die eine Triangulation verbindet, wie im Artikel.</translation>
  </message>
  <message>
   <source>For MinSize and MinLength. Smaller parts are not cut off, smaller holes attract no cuts, and the length of the outline is measured without the detail that is much smaller. 0: everything counts.</source>
   <translation>Für MinSize und MinLength. Kleinere Teile werden nicht abgeschnitten, kleinere Löcher ziehen keine Schnitte an, und die Länge des Umrisses wird ohne die viel kleineren Einzelheiten gemessen. 0: Alles zählt.</translation>
  </message>
  <message>
   <source>For each metre of boundary. Not set: 45 (balanced), 11.25 (keep classes), 90 (compact).</source>
   <translation>Für jeden Meter Grenze. Ohne Angabe: 45 (balanced), 11,25 (keep classes), 90 (compact).</translation>
  </message>
  <message>
   <source>For each square metre times class distance. Not set: 1, as all named weights have it.</source>
   <translation>Für jeden Quadratmeter mal Abstand der Klassen. Ohne Angabe: 1, wie bei allen Gewichten mit Namen.</translation>
  </message>
  <message>
   <source>For each square metre times metre. Not set: 0.00014 (balanced), 0.000035 (keep classes), 0.00056 (compact).</source>
   <translation>Für jeden Quadratmeter mal Meter. Ohne Angabe: 0,00014 (balanced), 0,000035 (keep classes), 0,00056 (compact).</translation>
  </message>
  <message>
   <source>Further layers to carry along</source>
   <translation>Weitere Layer, die mitgeführt werden</translation>
  </message>
  <message>
   <source>Growth of the map (%)</source>
   <translation>Wachstum der Karte (%)</translation>
  </message>
  <message>
   <source>Help</source>
   <translation>Hilfe</translation>
  </message>
  <message>
   <source>Hierarchy of natural parts</source>
   <translation>Hierarchie natürlicher Teile</translation>
  </message>
  <message>
   <source>Holes with a smaller area stay holes of a part, and no cut is attached to them. In the squared units of the layer, or in square metres if its coordinates are degrees. A field or expression can set it for each feature.</source>
   <translation>Löcher mit kleinerer Fläche bleiben Löcher eines Teils, und kein Schnitt schließt sie an. In den Quadrateinheiten des Layers, oder in Quadratmetern, wenn seine Koordinaten Grad sind. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>How large every region must be at least. Classes in the table of minimum sizes have their own.</source>
   <translation>Wie groß jede Region mindestens sein muss. Klassen in der Tabelle der Mindestgrößen haben ihre eigene.</translation>
  </message>
  <message>
   <source>How many moves are tried.</source>
   <translation>Wie viele Züge versucht werden.</translation>
  </message>
  <message>
   <source>How many times as large the region becomes, exactly. Below 1 it shrinks; 1 changes nothing.</source>
   <translation>Wievielmal so groß die Region wird, auf den Punkt genau. Unter 1 schrumpft sie; 1 ändert nichts.</translation>
  </message>
  <message>
   <source>How many times longer than the straight line across a neck the way along the outline may be; at least 1. Smaller values cut more.</source>
   <translation>Wievielmal so lang der Weg am Umriss entlang sein darf wie die gerade Linie über eine Engstelle (tau); mindestens 1. Kleinere Werte schneiden mehr.</translation>
  </message>
  <message>
   <source>How many times longer than the straight line across a neck the way along the outline may be; at least 1. Smaller values cut more. A field or expression can set it for each feature.</source>
   <translation>Wievielmal so lang der Weg am Umriss entlang sein darf wie die gerade Linie über eine Engstelle (tau); mindestens 1. Kleinere Werte schneiden mehr. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>How much wider and higher the frame may become, to both sides. It grows by less where less is enough: a region that takes the share f of the width lets the map grow to scale times f to the power 2/7. 0 keeps the extent. Not used where the frame is switched off.</source>
   <translation>Um wie viel breiter und höher der Rahmen werden darf, nach beiden Seiten. Er wächst um weniger, wo weniger genügt: Nimmt eine Region den Anteil f der Breite ein, wächst die Karte auf das Maß Vergrößerung mal f hoch 2/7. 0 erhält die Ausdehnung. Ohne Rahmen nicht verwendet.</translation>
  </message>
  <message>
   <source>If these are too many, set PLACES to Natural or raise SMALLEST_PART.</source>
   <translation>Wenn das zu viele sind, setzen Sie PLACES auf Natural oder erhöhen Sie SMALLEST_PART.</translation>
  </message>
  <message>
   <source>Ignore cuts below (layer units; metres if degrees)</source>
   <translation>Mindestlänge der Schnitte (Layereinheiten; Grad: m)</translation>
  </message>
  <message>
   <source>Ignore holes below (layer units²; m² if degrees)</source>
   <translation>Mindestfläche der Löcher (Layereinheiten²; Grad: m²)</translation>
  </message>
  <message>
   <source>In the CRS of the layer, {}, areas in the middle of the map are {:.2f} times as large as on the ground, and all sizes are measured in it. Use Reproject layer first, to an equal-area CRS.</source>
   <translation>Im KBS des Layers, {}, sind Flächen in der Mitte der Karte {:.2f}-mal so groß wie in der Natur, und alle Größen werden darin gemessen. Bitte den Layer zuerst in ein flächentreues KBS reprojizieren.</translation>
  </message>
  <message>
   <source>In the folder: {names}</source>
   <translation>Im Ordner: {names}</translation>
  </message>
  <message>
   <source>In the window of QGIS, Plugins &gt; Isthmus &gt; Install packages does it. Or run this {}, then restart QGIS: {} ({}the last word keeps QGIS's own numpy)</source>
   <translation>Im Fenster von QGIS geht das über Erweiterungen &gt; Isthmus &gt; Pakete installieren. Oder führen Sie {} diesen Befehl aus und starten dann QGIS neu: {} ({}das letzte Wort bewahrt das numpy von QGIS)</translation>
  </message>
  <message>
   <source>Install packages…</source>
   <translation>Pakete installieren…</translation>
  </message>
  <message>
   <source>Isthmus example</source>
   <translation>Beispiel für Isthmus</translation>
  </message>
  <message>
   <source>Isthmus: fetching packages</source>
   <translation>Isthmus: Pakete werden geholt</translation>
  </message>
  <message>
   <source>Isthmus: finding cuts</source>
   <translation>Isthmus: Schnitte werden gesucht</translation>
  </message>
  <message>
   <source>Isthmus: install packages</source>
   <translation>Isthmus: Pakete installieren</translation>
  </message>
  <message>
   <source>Isthmus: natural partitions of polygons</source>
   <translation>Isthmus: natürliche Zerlegung von Polygonen</translation>
  </message>
  <message>
   <source>Isthmus: try values of tau</source>
   <translation>Isthmus: Werte von tau ausprobieren</translation>
  </message>
  <message>
   <source>It cuts all features of the layer, for the command line knows no selection.</source>
   <translation>Er zerlegt alle Objekte des Layers, denn die Kommandozeile kennt keine Auswahl.</translation>
  </message>
  <message>
   <source>It has no neighbours that would make it large enough.</source>
   <translation>Sie hat keine Nachbarn, mit denen sie groß genug würde.</translation>
  </message>
  <message>
   <source>It may not be used commercially.</source>
   <translation>Es darf nicht kommerziell genutzt werden.</translation>
  </message>
  <message>
   <source>Joins small land-cover areas to regions of a minimum size at least cost.</source>
   <translation>Vereinigt kleine Flächen der Bodenbedeckung zu geringsten Kosten zu Regionen einer Mindestgröße.</translation>
  </message>
  <message>
   <source>Keep the extent of the map (frame)</source>
   <translation>Ausdehnung der Karte erhalten (Rahmen)</translation>
  </message>
  <message>
   <source>Largest detour (tau)</source>
   <translation>Größter Umweg (tau)</translation>
  </message>
  <message>
   <source>Largest dilation of a candidate</source>
   <translation>Größter verbliebener Umweg</translation>
  </message>
  <message>
   <source>Largest gap to the proven lower bound (per cent)</source>
   <translation>Größter Abstand zur unteren Schranke (Prozent)</translation>
  </message>
  <message>
   <source>Largest tau (0: no bound)</source>
   <translation>Größtes tau (0: unbegrenzt)</translation>
  </message>
  <message>
   <source>Left where they are, since coordinates are not finite (NaN or infinity) or larger than {:g}: feature {}.</source>
   <translation>Bleiben, wo sie sind, da Koordinaten nicht endlich (NaN oder unendlich) oder größer als {:g} sind: Objekt {}.</translation>
  </message>
  <message>
   <source>Lengths are in the units of the layer, or metres for degrees.</source>
   <translation>Längen sind in den Einheiten des Layers angegeben, bei Grad in Metern.</translation>
  </message>
  <message>
   <source>Lines to choose the cuts from</source>
   <translation>Linien, aus denen Schnitte gewählt werden</translation>
  </message>
  <message>
   <source>Lost areas</source>
   <translation>Verlorene Flächen</translation>
  </message>
  <message>
   <source>Lower bound of the total cost (exact)</source>
   <translation>Untere Schranke der Gesamtkosten (exact)</translation>
  </message>
  <message>
   <source>MPL-2.0</source>
   <translation>MPL-2.0</translation>
  </message>
  <message>
   <source>Map (polygons or lines)</source>
   <translation>Karte (Polygone oder Linien)</translation>
  </message>
  <message>
   <source>Median angular distortion (degrees)</source>
   <translation>Mittlere Winkelverzerrung (Median, Grad)</translation>
  </message>
  <message>
   <source>Method</source>
   <translation>Verfahren</translation>
  </message>
  <message>
   <source>MinSize: as few cuts as possible. MinLength: as little length of cuts as possible.</source>
   <translation>MinSize: möglichst wenige Schnitte. MinLength: möglichst wenig Länge der Schnitte.</translation>
  </message>
  <message>
   <source>MinSize: the fewest edges so that no way along outline and edges is more than tau times as long as the straight line, for all diagonals of a triangulation. MinLength: those of least total length. Greedy: van Dijk and others 2013. Proximity: Harrie and Sarjakoski 2002. None: only the lines of the map.</source>
   <translation>MinSize: die wenigsten Kanten, bei denen für alle Diagonalen einer Triangulation kein Weg am Umriss und an den Kanten entlang mehr als tau-mal so lang ist wie die gerade Linie. MinLength: die mit der kleinsten Gesamtlänge. Greedy: van Dijk u. a. 2013. Proximity: Harrie und Sarjakoski 2002. None: nur die Linien der Karte.</translation>
  </message>
  <message>
   <source>MinSize: the number of cuts. MinLength: their total length, which gives the most natural parts. MinWeight: the sum of the weights that you give them.</source>
   <translation>MinSize: die Anzahl der Schnitte. MinLength: ihre Gesamtlänge, was die natürlichsten Teile ergibt. MinWeight: die Summe der Gewichte, die Sie ihnen geben.</translation>
  </message>
  <message>
   <source>MinWeight needs an expression for the weight of a candidate (WEIGHT).</source>
   <translation>MinWeight braucht einen Ausdruck für das Gewicht eines möglichen Schnitts (WEIGHT).</translation>
  </message>
  <message>
   <source>Minimum size (square metres)</source>
   <translation>Mindestgröße (Quadratmeter)</translation>
  </message>
  <message>
   <source>Minimum size: {} square metres.</source>
   <translation>Mindestgröße: {} Quadratmeter.</translation>
  </message>
  <message>
   <source>Minimum size: {} square metres; of some classes another.</source>
   <translation>Mindestgröße: {} Quadratmeter; bei einigen Klassen eine andere.</translation>
  </message>
  <message>
   <source>Minimum sizes by class</source>
   <translation>Mindestgrößen nach Klasse</translation>
  </message>
  <message>
   <source>Most steps of a feature</source>
   <translation>Höchstzahl der Stufen eines Objekts</translation>
  </message>
  <message>
   <source>Natural</source>
   <translation>Natürlich (Natural)</translation>
  </message>
  <message>
   <source>Natural: only where people see parts meet, at places where the outline is concave and the polygon opens up beside the cut, or over a row of small holes that fills half of the way. Any: between any two vertices that a triangulation joins, as in the paper.</source>
   <translation>Natural (natürlich): nur wo Menschen Teile aneinanderstoßen sehen, an Stellen, wo der Umriss einspringt und sich das Polygon neben dem Schnitt weitet, oder über eine Reihe kleiner Löcher, die den halben Weg füllt. Any (überall): zwischen je zwei Stützpunkten, die eine Triangulation verbindet, wie im Artikel.</translation>
  </message>
  <message>
   <source>Neighbours</source>
   <translation>Nachbarn</translation>
  </message>
  <message>
   <source>No area has a class: there is nothing to aggregate.</source>
   <translation>Keine Fläche hat eine Klasse: Es gibt nichts zusammenzufassen.</translation>
  </message>
  <message>
   <source>No area is above half of its minimum size.</source>
   <translation>Keine Fläche liegt über der halben Mindestgröße.</translation>
  </message>
  <message>
   <source>No longer valid, since they are narrower than 1e-10 of the map's width where others meet them (Fix geometries mends them): feature {}.</source>
   <translation>Nicht mehr gültig, da schmaler als 1e-10 der Breite der Karte, wo andere sie berühren oder kreuzen („Geometrien reparieren“ behebt es): Objekt {}.</translation>
  </message>
  <message>
   <source>No region may have a class of the map: all of them are excluded.</source>
   <translation>Keine Region darf eine Klasse der Karte haben: Alle sind ausgeschlossen.</translation>
  </message>
  <message>
   <source>No region reaches its minimum size: is the threshold larger than the map? Those that hang together by shared boundaries have {} square metres at most.</source>
   <translation>Keine Region erreicht ihre Mindestgröße: Ist die Mindestgröße größer als die Karte? Was durch gemeinsame Grenzen zusammenhängt, hat höchstens {} Quadratmeter.</translation>
  </message>
  <message>
   <source>No relevant edges for {}.</source>
   <translation>Keine relevanten Kanten für {}.</translation>
  </message>
  <message>
   <source>No solution costs less than {}</source>
   <translation>Keine Lösung kostet weniger als {}</translation>
  </message>
  <message>
   <source>No solution in which every area that is large enough by itself is a core costs less than {}</source>
   <translation>Keine Lösung, in der jede für sich schon ausreichend große Fläche ein Kern ist, kostet weniger als {}</translation>
  </message>
  <message>
   <source>No step pays off more than another.</source>
   <translation>Keine Stufe lohnt sich mehr als eine andere.</translation>
  </message>
  <message>
   <source>No vertex to end a cut at: {}, edges opposite a concave corner, where the way around is more than tau times as long as the way across. Set NEW_VERTICES to cut there.</source>
   <translation>Kein Stützpunkt, an dem ein Schnitt enden könnte: {}, Kanten gegenüber einer einspringenden Ecke, wo der Weg herum mehr als tau-mal so lang ist wie der Weg hinüber. Setzen Sie NEW_VERTICES, um dort zu schneiden.</translation>
  </message>
  <message>
   <source>Not cut: {}; see the field status of the parts.</source>
   <translation>Nicht zerlegt: {}; siehe das Feld status der Teile.</translation>
  </message>
  <message>
   <source>Not everything can be cut: {reasons}</source>
   <translation>Nicht alles lässt sich zerlegen: {reasons}</translation>
  </message>
  <message>
   <source>Not everything could be written to {}. Is the disk full? Some formats also drop features without geometry; a GeoPackage keeps them.</source>
   <translation>Nicht alles konnte nach {} geschrieben werden. Ist der Datenträger voll? Manche Formate verwerfen auch Objekte ohne Geometrie; ein GeoPackage behält sie.</translation>
  </message>
  <message>
   <source>Not valid (an outline crosses itself, for one): {}, {}{}. Their sizes and neighbours may be wrong. Run Fix geometries on the layer first.</source>
   <translation>Ungültig (etwa, weil ein Umriss sich selbst kreuzt): {}, {}{}. Größen und Nachbarn können falsch sein. Führen Sie auf dem Layer zuerst „Geometrien reparieren“ aus.</translation>
  </message>
  <message>
   <source>Nothing is missing: all tools can run.</source>
   <translation>Es fehlt nichts: Alle Werkzeuge können laufen.</translation>
  </message>
  <message>
   <source>Number of areas</source>
   <translation>Anzahl der Flächen</translation>
  </message>
  <message>
   <source>Number of areas above half of the minimum size that lost their class</source>
   <translation>Anzahl der Flächen über der halben Mindestgröße, die ihre Klasse verloren haben</translation>
  </message>
  <message>
   <source>Number of areas not cut for a reason</source>
   <translation>Anzahl der Flächen, die nicht zerlegt werden konnten</translation>
  </message>
  <message>
   <source>Number of areas without geometry or class</source>
   <translation>Anzahl der Flächen ohne Geometrie oder Klasse</translation>
  </message>
  <message>
   <source>Number of cuts</source>
   <translation>Anzahl der Schnitte</translation>
  </message>
  <message>
   <source>Number of features not solved</source>
   <translation>Anzahl der nicht gelösten Objekte</translation>
  </message>
  <message>
   <source>Number of gaps</source>
   <translation>Anzahl der Lücken</translation>
  </message>
  <message>
   <source>Number of new crossings</source>
   <translation>Anzahl der neuen Kreuzungen</translation>
  </message>
  <message>
   <source>Number of overlapping pairs of areas</source>
   <translation>Anzahl der Paare überlappender Flächen</translation>
  </message>
  <message>
   <source>Number of parts</source>
   <translation>Anzahl der Teile</translation>
  </message>
  <message>
   <source>Number of parts in all levels</source>
   <translation>Anzahl der Teile in allen Stufen</translation>
  </message>
  <message>
   <source>Number of parts of each feature</source>
   <translation>Anzahl der Teile jedes Objekts</translation>
  </message>
  <message>
   <source>Number of pieces</source>
   <translation>Anzahl der Stücke</translation>
  </message>
  <message>
   <source>Number of regions</source>
   <translation>Anzahl der Regionen</translation>
  </message>
  <message>
   <source>Number of regions (0: free)</source>
   <translation>Anzahl der Regionen (0: frei)</translation>
  </message>
  <message>
   <source>Number of regions that are too small</source>
   <translation>Anzahl der zu kleinen Regionen</translation>
  </message>
  <message>
   <source>Number of relevant edges</source>
   <translation>Anzahl der relevanten Kanten</translation>
  </message>
  <message>
   <source>On the command line</source>
   <translation>Auf der Kommandozeile</translation>
  </message>
  <message>
   <source>On: the map stays inside the extent that it has, but for the growth below, and reaches to its sides. Off: it grows as it likes, the region stays where it is, and the outermost points keep their scale.</source>
   <translation>An: Die Karte bleibt in ihrer Ausdehnung, bis auf das Wachstum unten, und reicht bis an deren Ränder. Aus: Sie wächst frei, die Region bleibt an ihrem Ort, und die äußersten Punkte behalten ihren Maßstab.</translation>
  </message>
  <message>
   <source>One or more polygons around what is to become larger. A rough outline will do: what counts are the points of the map inside.</source>
   <translation>Ein oder mehrere Polygone um das, was größer werden soll. Ein grober Umriss genügt: Es zählen die Punkte der Karte darin.</translation>
  </message>
  <message>
   <source>One page for each tool, written by `./run docs` from the tool itself.</source>
   <translation>Eine Seite je Werkzeug, von `./run docs` aus dem Werkzeug selbst geschrieben.</translation>
  </message>
  <message>
   <source>Only the level with so many parts</source>
   <translation>Nur die Stufe mit so vielen Teilen</translation>
  </message>
  <message>
   <source>PARTS must be a whole number of at least 1, and is {:g}</source>
   <translation>PARTS muss eine ganze Zahl ab 1 sein und ist {:g}</translation>
  </message>
  <message>
   <source>Parameters</source>
   <translation>Parameter</translation>
  </message>
  <message>
   <source>Partition</source>
   <translation>Zerlegung</translation>
  </message>
  <message>
   <source>Partition polygons at bottlenecks</source>
   <translation>Polygone an Engstellen zerlegen</translation>
  </message>
  <message>
   <source>Partition polygons within a budget</source>
   <translation>Polygone mit einem Budget zerlegen</translation>
  </message>
  <message>
   <source>Parts</source>
   <translation>Teile</translation>
  </message>
  <message>
   <source>Parts of all levels</source>
   <translation>Teile aller Stufen</translation>
  </message>
  <message>
   <source>Pieces</source>
   <translation>Stücke</translation>
  </message>
  <message>
   <source>Please start QGIS again: an older shapely is in use.</source>
   <translation>Bitte starten Sie QGIS neu: Ein älteres shapely ist in Gebrauch.</translation>
  </message>
  <message>
   <source>Polygons</source>
   <translation>Polygone</translation>
  </message>
  <message>
   <source>Possible cuts that are shorter than this are left out, whatever the detour: those of creeks and inlets you do not care for. A hole may still be connected by a shorter cut. In the units of the layer, or in metres if its coordinates are degrees. A field or expression can set it for each feature.</source>
   <translation>Mögliche Schnitte, die kürzer sind, fallen weg, wie groß der Umweg auch ist: die von Bächen und kleinen Buchten, auf die es Ihnen nicht ankommt. Ein Loch kann trotzdem durch einen kürzeren Schnitt angeschlossen werden. In den Einheiten des Layers, oder in Metern, wenn seine Koordinaten Grad sind. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>Prepare areas for aggregation</source>
   <translation>Flächen zum Zusammenfassen vorbereiten</translation>
  </message>
  <message>
   <source>Proven lower bound of the cost</source>
   <translation>Bewiesene untere Schranke der Kosten</translation>
  </message>
  <message>
   <source>Put into lines where others meet, cross or nearly touch them: {}.</source>
   <translation>In Linien eingefügt, wo andere auf sie treffen, sie kreuzen oder beinahe berühren: {}.</translation>
  </message>
  <message>
   <source>QGIS cannot read {} ({}): has it a coordinate that is not finite? Delete such features, or use another version of QGIS.</source>
   <translation>QGIS kann {} nicht lesen ({}): Ist darin eine Koordinate nicht endlich? Löschen Sie solche Objekte, oder verwenden Sie eine andere Version von QGIS.</translation>
  </message>
  <message>
   <source>Reading the areas</source>
   <translation>Lese die Flächen</translation>
  </message>
  <message>
   <source>Reference</source>
   <translation>Referenz</translation>
  </message>
  <message>
   <source>Region to enlarge</source>
   <translation>Zu vergrößernde Region</translation>
  </message>
  <message>
   <source>Region {} around area {} ({} square metres) could not be helped: {}.</source>
   <translation>Für Region {} um Fläche {} ({} Quadratmeter) gab es keine Abhilfe: {}.</translation>
  </message>
  <message>
   <source>Regions</source>
   <translation>Regionen</translation>
  </message>
  <message>
   <source>Relevant edges</source>
   <translation>Relevante Kanten</translation>
  </message>
  <message>
   <source>Relevant edges used</source>
   <translation>Verwendete relevante Kanten</translation>
  </message>
  <message>
   <source>Removed.</source>
   <translation>Entfernt.</translation>
  </message>
  <message>
   <source>Report</source>
   <translation>Bericht</translation>
  </message>
  <message>
   <source>Results</source>
   <translation>Ergebnisse</translation>
  </message>
  <message>
   <source>Returned as well:</source>
   <translation>Außerdem liefert das Werkzeug:</translation>
  </message>
  <message>
   <source>Rivers, towns, labels: deformed as the map around them. Lines get points where the map bends them.</source>
   <translation>Flüsse, Orte, Beschriftungen: verformt wie die Karte um sie herum. Linien bekommen Punkte, wo die Karte sie biegt.</translation>
  </message>
  <message>
   <source>Rule for relevant edges, where none are given</source>
   <translation>Regel für relevante Kanten, wo keine gegeben sind</translation>
  </message>
  <message>
   <source>Save the layer first, as polygons.gpkg: it is only in memory.</source>
   <translation>Speichern Sie den Layer zuerst, als polygons.gpkg: Er ist nur im Arbeitsspeicher.</translation>
  </message>
  <message>
   <source>Scale (times as large)</source>
   <translation>Vergrößerung (wievielmal so groß)</translation>
  </message>
  <message>
   <source>Scale reached in the focus</source>
   <translation>In der Region erreichte Vergrößerung</translation>
  </message>
  <message>
   <source>Seconds to search (0: not limited)</source>
   <translation>Sekunden für die Suche (0: unbegrenzt)</translation>
  </message>
  <message>
   <source>Seed of annealing</source>
   <translation>Startwert des Zufalls (annealing)</translation>
  </message>
  <message>
   <source>Selected features only</source>
   <translation>Nur gewählte Objekte</translation>
  </message>
  <message>
   <source>Set aside: {} and {} with less on one side than SMALLEST_PART (or MIN_HOLE); {} where the outline is not concave or the polygon does not open up (PLACES). If you miss cuts, lower TAU or SMALLEST_PART, or set PLACES to Any; if there are too many, raise TAU.</source>
   <translation>Nicht beachtet: {} und {} mit weniger auf einer Seite als SMALLEST_PART (oder MIN_HOLE); {}, wo der Umriss nicht einspringt oder das Polygon sich nicht weitet (PLACES). Wenn Schnitte fehlen, senken Sie TAU oder SMALLEST_PART, oder setzen Sie PLACES auf Any; wenn es zu viele sind, erhöhen Sie TAU.</translation>
  </message>
  <message>
   <source>Shapely's triangulation is used: as good as others, but slower.</source>
   <translation>Shapely trianguliert: so gut wie andere, aber langsamer.</translation>
  </message>
  <message>
   <source>Share of the area whose class changed</source>
   <translation>Anteil der Fläche, deren Klasse gewechselt hat</translation>
  </message>
  <message>
   <source>Shows what each value of tau costs, and marks the values that pay off.</source>
   <translation>Zeigt, was jeder Wert von tau kostet, und hebt die Werte hervor, die sich lohnen.</translation>
  </message>
  <message>
   <source>Smaller parts are not cut off, smaller holes attract no cuts, and the length of the outline is measured without the detail that is much smaller. 0: everything counts. A field or expression can set it for each feature.</source>
   <translation>Kleinere Teile werden nicht abgeschnitten, kleinere Löcher ziehen keine Schnitte an, und die Länge des Umrisses wird ohne die viel kleineren Einzelheiten gemessen. 0: Alles zählt. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>Smaller values give more edges and a stiffer map. Not used by Proximity; where there are islands, edges join them by the same measure.</source>
   <translation>Kleinere Werte ergeben mehr Kanten und eine steifere Karte. Bei Proximity nicht verwendet; wo es Inseln gibt, verbinden Kanten sie nach demselben Maß.</translation>
  </message>
  <message>
   <source>Smallest part (per cent of the feature)</source>
   <translation>Kleinster Teil (Prozent des Objekts)</translation>
  </message>
  <message>
   <source>Smallest part (per cent of the polygon)</source>
   <translation>Kleinster Teil (Prozent des Polygons)</translation>
  </message>
  <message>
   <source>Smallest part (per cent)</source>
   <translation>Kleinster Teil (Prozent)</translation>
  </message>
  <message>
   <source>Smallest tau</source>
   <translation>Kleinstes tau</translation>
  </message>
  <message>
   <source>Smallest tau, where the finest level begins</source>
   <translation>Kleinstes tau, mit dem die feinste Stufe beginnt</translation>
  </message>
  <message>
   <source>Solved by the exact method, since they have at most {} areas: {}.</source>
   <translation>Mit der exakten Methode gelöst, da sie höchstens {} Flächen haben: {}.</translation>
  </message>
  <message>
   <source>Splits land-cover areas at bottlenecks before they are aggregated.</source>
   <translation>Zerlegt Flächen der Bodenbedeckung an Engstellen, bevor sie zusammengefasst werden.</translation>
  </message>
  <message>
   <source>Steps of annealing (0: 10,000 an area)</source>
   <translation>Schritte der Abkühlung (0: 10.000 je Fläche)</translation>
  </message>
  <message>
   <source>Stopped. Nothing was changed.</source>
   <translation>Abgebrochen. Es wurde nichts geändert.</translation>
  </message>
  <message>
   <source>TAU_MAX must be 0 or at least TAU_MIN ({:g}), and is {:g}.</source>
   <translation>TAU_MAX muss 0 oder mindestens TAU_MIN ({:g}) sein und ist {:g}.</translation>
  </message>
  <message>
   <source>Table of class distances</source>
   <translation>Tabelle der Klassenabstände</translation>
  </message>
  <message>
   <source>The CRS of the layer, {}, is in degrees, but the layer reaches from latitude {:.10g} to {:.10g}: sizes and lengths will be wrong. Give it the CRS that it has (Assign projection).</source>
   <translation>Das KBS des Layers, {}, ist in Grad, aber der Layer reicht von Breite {:.10g} bis {:.10g}: Größen und Längen werden falsch. Bitte das richtige KBS setzen (Projektion zuweisen).</translation>
  </message>
  <message>
   <source>The Python package {} is faster.</source>
   <translation>Das Python-Paket {} ist schneller.</translation>
  </message>
  <message>
   <source>The areas have no field {!r} ({}). Their fields are: {}.</source>
   <translation>Die Flächen haben kein Feld {!r} ({}). Ihre Felder sind: {}.</translation>
  </message>
  <message>
   <source>The areas of a map, which fill it without overlaps and gaps.</source>
   <translation>Die Flächen einer Karte, die sie ohne Überlappungen und Lücken füllen.</translation>
  </message>
  <message>
   <source>The areas with all fields, region, new_class, changed (1 or 0) and status.</source>
   <translation>Die Flächen mit allen Feldern, dazu region, new_class, changed (1 oder 0) und status.</translation>
  </message>
  <message>
   <source>The command is on the clipboard.</source>
   <translation>Der Befehl ist in der Zwischenablage.</translation>
  </message>
  <message>
   <source>The costs of {} cannot be computed: up to {:g}, they are too large. Give a smaller weight (or class distances), and see that no area is far away by mistake.</source>
   <translation>Die Kosten „{}“ lassen sich nicht berechnen: Mit bis zu {:g} sind sie zu groß. Geben Sie ein kleineres Gewicht (oder kleinere Klassenabstände) an, und sehen Sie nach, ob eine Fläche versehentlich weit entfernt liegt.</translation>
  </message>
  <message>
   <source>The curve ends after so many steps, though the smallest tau may not be reached.</source>
   <translation>Die Kurve endet nach so vielen Stufen, auch wenn das kleinste tau noch nicht erreicht ist.</translation>
  </message>
  <message>
   <source>The cuts, with the id of their polygon (source), length (without that over holes), detour (how many times longer the way along the outline was; empty if only a cut connects the ends), persistence (the tau up to which the cut is needed) and rank (1 for the most persistent of the feature).</source>
   <translation>Die Schnitte mit der ID ihres Polygons (source), length (Länge, ohne die über Löcher), detour (wievielmal so lang der Weg am Umriss entlang war; leer, wenn nur ein Schnitt die Enden verbindet), persistence (bis zu welchem tau der Schnitt gebraucht wird) und rank (1 für den mit der größten Persistenz im Objekt).</translation>
  </message>
  <message>
   <source>The cuts, with the id of their polygon (source), length (without that over holes), detour (how many times longer the way along the outline was; empty if only a cut connects the ends), the parts on both sides (part_a, part_b; equal where a cut only connects a hole), and share (the smaller side as per cent of the feature's area; empty where that was not measured).</source>
   <translation>Die Schnitte mit der ID ihres Polygons (source), length (Länge, ohne die über Löcher), detour (wievielmal so lang der Weg am Umriss entlang war; leer, wenn nur ein Schnitt die Enden verbindet), den Teilen auf beiden Seiten (part_a, part_b; gleich, wo ein Schnitt nur ein Loch anschließt) und share (die kleinere Seite in Prozent der Fläche des Objekts; leer, wo das nicht gemessen wurde).</translation>
  </message>
  <message>
   <source>The distance from {} to {}</source>
   <translation>Der Klassenabstand von {} zu {}</translation>
  </message>
  <message>
   <source>The excluded class {} is not on the map.</source>
   <translation>Die ausgeschlossene Klasse {} kommt auf der Karte nicht vor.</translation>
  </message>
  <message>
   <source>The expression for {} is not valid: {}</source>
   <translation>Der Ausdruck für {} ist ungültig: {}</translation>
  </message>
  <message>
   <source>The expression for {} uses an unknown field: {}.</source>
   <translation>Der Ausdruck für {} enthält ein unbekanntes Feld: {}.</translation>
  </message>
  <message>
   <source>The field that is equal for the pieces of one area. Default: area_id, if there are fields area_id and piece.</source>
   <translation>Das Feld, das für die Stücke einer Fläche gleich ist. Ohne Angabe: area_id, wenn es Felder area_id und piece gibt.</translation>
  </message>
  <message>
   <source>The field with the class of each area.</source>
   <translation>Das Feld mit der Klasse jeder Fläche.</translation>
  </message>
  <message>
   <source>The field with the class of each area. Areas without one are reported.</source>
   <translation>Das Feld mit der Klasse jeder Fläche. Flächen ohne Klasse werden gemeldet.</translation>
  </message>
  <message>
   <source>The field {} tells which pieces belong to one area.</source>
   <translation>Das Feld {} sagt, welche Stücke zu einer Fläche gehören.</translation>
  </message>
  <message>
   <source>The format keeps a field {} of its own: rename that of the input, or choose another format.</source>
   <translation>Das Format hat selbst ein Feld {}: Benennen Sie das der Eingabe um, oder wählen Sie ein anderes Format.</translation>
  </message>
  <message>
   <source>The largest detour in the finest level: how many times longer than the straight line across a neck the way along the outline may be; at least 1. Smaller values cut more. A field or expression can set it for each feature.</source>
   <translation>Der größte Umweg in der feinsten Stufe: wievielmal so lang der Weg am Umriss entlang sein darf wie die gerade Linie über eine Engstelle; mindestens 1. Kleinere Werte schneiden mehr. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>The largest number of cuts (MinSize), total length (MinLength) or total weight (MinWeight) for each feature; length in the units of the layer, or in metres if its coordinates are degrees. A field or expression can set it for each feature.</source>
   <translation>Die größte Anzahl von Schnitten (MinSize), Gesamtlänge (MinLength) oder Summe der Gewichte (MinWeight) für jedes Objekt; Längen in den Einheiten des Layers, oder in Metern, wenn seine Koordinaten Grad sind. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen.</translation>
  </message>
  <message>
   <source>The layer of the region to enlarge has no polygons whose coordinates are finite.</source>
   <translation>Der Layer der zu vergrößernden Region hat keine Polygone mit endlichen Koordinaten.</translation>
  </message>
  <message>
   <source>The layers could not be written.</source>
   <translation>Die Layer konnten nicht geschrieben werden.</translation>
  </message>
  <message>
   <source>The map becomes {:.0f} % wider and {:.0f} % higher.</source>
   <translation>Die Karte wird um {:.0f} % breiter und um {:.0f} % höher.</translation>
  </message>
  <message>
   <source>The map has no features with a geometry that can be moved.</source>
   <translation>Die Karte hat keine Objekte, deren Geometrie sich verschieben lässt.</translation>
  </message>
  <message>
   <source>The map is in degrees ({}), and ({:g} {:g}) is beyond the globe. Is its CRS right?</source>
   <translation>Die Karte ist in Grad ({}), und ({:g} {:g}) liegt jenseits des Globus. Stimmt ihr KBS?</translation>
  </message>
  <message>
   <source>The map is in degrees ({}). It is solved in the equidistant cylindrical projection with true lengths at latitude {:.1f}, and the result is in degrees.</source>
   <translation>Die Karte ist in Grad ({}). Gerechnet wird in der abstandstreuen Zylinderprojektion, die bei der Breite {:.1f} längentreu ist; das Ergebnis ist in Grad.</translation>
  </message>
  <message>
   <source>The map would grow beyond the globe. Keep its extent (switch the frame on).</source>
   <translation>Die Karte würde über den Globus hinauswachsen. Behalten Sie ihre Ausdehnung bei (Rahmen einschalten).</translation>
  </message>
  <message>
   <source>The number of regions is not used by the exact method.</source>
   <translation>Das exakte Verfahren beachtet die Anzahl der Regionen nicht.</translation>
  </message>
  <message>
   <source>The polygons or lines of the map. All features are solved together.</source>
   <translation>Die Polygone oder Linien der Karte. Alle Objekte werden gemeinsam gelöst.</translation>
  </message>
  <message>
   <source>The polygons to cut.</source>
   <translation>Die Polygone, die zerlegt werden.</translation>
  </message>
  <message>
   <source>The regions with region (number), the class field, size (square metres), areas (how many), core (id of the area whose class was kept) and status (why it is too small).</source>
   <translation>Die Regionen mit region (Nummer), dem Klassenfeld, size (Quadratmeter), areas (wie viele Flächen), core (ID der Fläche, deren Klasse erhalten ist) und status (warum sie zu klein ist).</translation>
  </message>
  <message>
   <source>The relevant edges where they are in the focus map: kind (selected, given, or join between islands), length before, and stretch (length after over length before).</source>
   <translation>Die relevanten Kanten, wo sie in der Fokuskarte liegen: kind (selected: gewählt, given: gegeben, join: Verbindung zwischen Inseln), length (Länge vorher) und stretch (Länge nachher durch Länge vorher).</translation>
  </message>
  <message>
   <source>The report could not be written: {}</source>
   <translation>Der Bericht konnte nicht geschrieben werden: {}</translation>
  </message>
  <message>
   <source>The steps that pay off most: the tau to set, and what it gives.</source>
   <translation>Die Stufen, die sich am meisten lohnen: das einzustellende tau, und was es ergibt.</translation>
  </message>
  <message>
   <source>The table of class distances (DISTANCES) is not used, since DISTANCE is {}. To use it, choose table.</source>
   <translation>Die Tabelle der Klassenabstände (DISTANCES) wird nicht verwendet, da DISTANCE auf {} steht. Wählen Sie table, um sie zu verwenden.</translation>
  </message>
  <message>
   <source>The table of class distances (DISTANCES) knows nothing of class {}, which is on the map. Add rows from this class to the others.</source>
   <translation>Die Tabelle der Klassenabstände (DISTANCES) kennt die Klasse {} nicht, die in der Karte vorkommt. Ergänzen Sie Zeilen von dieser Klasse zu den anderen.</translation>
  </message>
  <message>
   <source>The table of class distances (DISTANCES) lacks {} pairs of classes that are on the map: {}. Add rows for them.</source>
   <translation>In der Tabelle der Klassenabstände (DISTANCES) fehlen {} Paare von Klassen, die in der Karte vorkommen: {}. Ergänzen Sie Zeilen für sie.</translation>
  </message>
  <message>
   <source>The table {} has no field {}. It has: {}.</source>
   <translation>Die Tabelle {} hat kein Feld {}. Sie hat: {}.</translation>
  </message>
  <message>
   <source>The threshold of class {}</source>
   <translation>Die Mindestgröße der Klasse {}</translation>
  </message>
  <message>
   <source>The time was over. {}</source>
   <translation>Die Zeit ist abgelaufen. {}</translation>
  </message>
  <message>
   <source>There is no wheel of {} for Python {} on {} with numpy {}. A newer QGIS may have one.</source>
   <translation>Es gibt kein fertiges Paket (Wheel) von {} für Python {} auf {} mit numpy {}. Für ein neueres QGIS gibt es vielleicht eines.</translation>
  </message>
  <message>
   <source>These Python packages are missing in QGIS. A click fetches them from pypi.org and puts them into the folder {folder}, which Isthmus alone adds to QGIS. The packages of QGIS, numpy above all, stay as they are.</source>
   <translation>Diese Python-Pakete fehlen in QGIS. Ein Klick holt sie von pypi.org und legt sie in den Ordner {folder}, den allein Isthmus zu QGIS hinzunimmt. Die Pakete von QGIS, vor allem numpy, bleiben, wie sie sind.</translation>
  </message>
  <message>
   <source>They are in use, and go when QGIS starts again.</source>
   <translation>Sie sind in Gebrauch und verschwinden, wenn QGIS neu startet.</translation>
  </message>
  <message>
   <source>This tool needs the Python package scipy. {}; on Debian and Ubuntu: apt install python3-scipy</source>
   <translation>Dieses Werkzeug braucht das Python-Paket scipy. {}; unter Debian und Ubuntu: apt install python3-scipy</translation>
  </message>
  <message>
   <source>Time (seconds)</source>
   <translation>Zeit (Sekunden)</translation>
  </message>
  <message>
   <source>Too large to be solved, and left as annealing found it: {}. {}</source>
   <translation>Zu groß, um gelöst zu werden, und so, wie die Abkühlung sie gefunden hat: {}. {}</translation>
  </message>
  <message>
   <source>Total cost</source>
   <translation>Gesamtkosten</translation>
  </message>
  <message>
   <source>Total length of the cuts</source>
   <translation>Gesamtlänge der Schnitte</translation>
  </message>
  <message>
   <source>Trade-off report</source>
   <translation>Bericht zur Umwegkurve</translation>
  </message>
  <message>
   <source>Trade-off steps</source>
   <translation>Stufen der Umwegkurve</translation>
  </message>
  <message>
   <source>Try it on an example</source>
   <translation>An einem Beispiel ausprobieren</translation>
  </message>
  <message>
   <source>Try values of tau…</source>
   <translation>Werte von tau ausprobieren…</translation>
  </message>
  <message>
   <source>Undo: remove them</source>
   <translation>Rückgängig: Pakete entfernen</translation>
  </message>
  <message>
   <source>Wanted number of regions, for greedy and annealing. Said if it cannot be reached.</source>
   <translation>Gewünschte Anzahl von Regionen, für greedy und annealing. Wenn sie nicht erreichbar ist, wird es gesagt.</translation>
  </message>
  <message>
   <source>Weight of a cut (for MinWeight)</source>
   <translation>Gewicht eines Schnitts (für MinWeight)</translation>
  </message>
  <message>
   <source>Weight of boundary length</source>
   <translation>Gewicht der Grenzlänge</translation>
  </message>
  <message>
   <source>Weight of centre distance</source>
   <translation>Gewicht der Entfernung vom Zentrum</translation>
  </message>
  <message>
   <source>Weight of class change</source>
   <translation>Gewicht des Klassenwechsels</translation>
  </message>
  <message>
   <source>Weights</source>
   <translation>Gewichte</translation>
  </message>
  <message>
   <source>Weights: class change {}, boundary {}, centre distance {}.</source>
   <translation>Gewichte: Klassenwechsel {}, Grenzlänge {}, Entfernung vom Zentrum {}.</translation>
  </message>
  <message>
   <source>What to minimize: number or length of cuts</source>
   <translation>Minimiert wird: Anzahl oder Länge der Schnitte</translation>
  </message>
  <message>
   <source>What to minimize: number, length or weight of cuts</source>
   <translation>Minimiert wird: Anzahl, Länge, Gewicht der Schnitte</translation>
  </message>
  <message>
   <source>What was half written has been removed.</source>
   <translation>Halb Geschriebenes wurde entfernt.</translation>
  </message>
  <message>
   <source>Where a cut may lie</source>
   <translation>Wo ein Schnitt liegen darf</translation>
  </message>
  <message>
   <source>Where the curve ends, at least 1.</source>
   <translation>Wo die Kurve endet, mindestens 1.</translation>
  </message>
  <message>
   <source>Where the curve starts; 0 starts with no cut at all, but those that connect holes.</source>
   <translation>Wo die Kurve beginnt; 0 beginnt ganz ohne Schnitte, bis auf die, die Löcher anschließen.</translation>
  </message>
  <message>
   <source>Without a class: {}. Aggregation will leave such areas as they are.</source>
   <translation>Ohne Klasse: {}. Beim Zusammenfassen bleiben solche Flächen, wie sie sind.</translation>
  </message>
  <message>
   <source>Write the layers</source>
   <translation>Layer schreiben</translation>
  </message>
  <message>
   <source>Writes just the level in which a feature has this number of parts, or the next best: all that there are, or one for each polygon of a multipart feature. A field or expression can set it for each feature; where it is empty, all levels are written.</source>
   <translation>Schreibt nur die Stufe, in der ein Objekt so viele Teile hat, oder die nächstbeste Anzahl: alle, die es gibt, oder einen für jedes Polygon eines mehrteiligen Objekts. Ein Feld oder Ausdruck kann den Wert für jedes Objekt setzen; wo er leer ist, werden alle Stufen geschrieben.</translation>
  </message>
  <message>
   <source>Your own lines, instead of the diagonals of a triangulation: straight lines between two vertices of a polygon that stay inside it, wherever they lie. A line that is none is reported with its id; where two cross, the shorter one is used.</source>
   <translation>Ihre eigenen Linien statt der Diagonalen einer Triangulation: gerade Linien zwischen zwei Stützpunkten eines Polygons, die in ihm bleiben, wo sie auch liegen. Eine Linie, die das nicht ist, wird mit ihrer ID gemeldet; wo zwei sich kreuzen, wird die kürzere verwendet.</translation>
  </message>
  <message>
   <source>Your own relevant edges, such as the cuts of the partition tool: lines between points of the map. If there are none, the tool finds them by the rule below.</source>
   <translation>Ihre eigenen relevanten Kanten, etwa die Schnitte des Werkzeugs zur Zerlegung: Linien zwischen Punkten der Karte. Gibt es keine, findet das Werkzeug sie nach der Regel unten.</translation>
  </message>
  <message>
   <source>a field or an expression, too</source>
   <translation>auch ein Feld oder Ausdruck</translation>
  </message>
  <message>
   <source>a ring has fewer than three distinct vertices</source>
   <translation>ein Ring hat weniger als drei verschiedene Stützpunkte</translation>
  </message>
  <message>
   <source>about {size}</source>
   <translation>etwa {size}</translation>
  </message>
  <message>
   <source>after</source>
   <translation>nachher</translation>
  </message>
  <message>
   <source>all of the input</source>
   <translation>alle der Eingabe</translation>
  </message>
  <message>
   <source>all tools need it</source>
   <translation>alle Werkzeuge brauchen es</translation>
  </message>
  <message>
   <source>an end is not a vertex of a polygon</source>
   <translation>ein Ende ist kein Stützpunkt eines Polygons</translation>
  </message>
  <message>
   <source>annealing: run this long instead of a number of steps; then two runs may differ. exact: the time limit, 60 if 0.</source>
   <translation>annealing: so lange laufen, statt einer Anzahl von Schritten; dann können zwei Läufe sich unterscheiden. exact: die Zeitgrenze, 60 bei 0.</translation>
  </message>
  <message>
   <source>area</source>
   <translation>Fläche</translation>
  </message>
  <message>
   <source>area {}</source>
   <translation>Fläche {}</translation>
  </message>
  <message>
   <source>areas</source>
   <translation>Flächen</translation>
  </message>
  <message>
   <source>at least {:g}</source>
   <translation>mindestens {:g}</translation>
  </message>
  <message>
   <source>at most {:g}</source>
   <translation>höchstens {:g}</translation>
  </message>
  <message>
   <source>before</source>
   <translation>vorher</translation>
  </message>
  <message>
   <source>boundary length</source>
   <translation>Grenzlänge</translation>
  </message>
  <message>
   <source>centre distance</source>
   <translation>Entfernung vom Zentrum</translation>
  </message>
  <message>
   <source>choice</source>
   <translation>Auswahl</translation>
  </message>
  <message>
   <source>class</source>
   <translation>Klasse</translation>
  </message>
  <message>
   <source>class change</source>
   <translation>Klassenwechsel</translation>
  </message>
  <message>
   <source>coordinates are not finite (NaN or infinity)</source>
   <translation>Koordinaten sind nicht endlich (NaN oder unendlich)</translation>
  </message>
  <message>
   <source>core outside</source>
   <translation>der Kern liegt außerhalb</translation>
  </message>
  <message>
   <source>cut</source>
   <translation>Schnitt</translation>
  </message>
  <message>
   <source>cuts</source>
   <translation>Schnitte</translation>
  </message>
  <message>
   <source>default</source>
   <translation>Vorgabe</translation>
  </message>
  <message>
   <source>diagonal</source>
   <translation>Diagonale</translation>
  </message>
  <message>
   <source>diagonals</source>
   <translation>Diagonalen</translation>
  </message>
  <message>
   <source>empty geometry</source>
   <translation>leere Geometrie</translation>
  </message>
  <message>
   <source>en</source>
   <translation>de</translation>
  </message>
  <message>
   <source>enlarged {:.10g} times, the focus is larger than the frame, which leaves room for a scale of {:g}. Choose a smaller scale, or let the map grow</source>
   <translation>auf das {:.10g}-Fache vergrößert ist die Region größer als der Rahmen, der nur eine Vergrößerung von {:g} zulässt. Wählen Sie eine kleinere, oder lassen Sie die Karte wachsen</translation>
  </message>
  <message>
   <source>equal: every change counts 1. code: hierarchical codes such as CORINE's; the share of the digits from the first differing one on (311 to 312: 1/3). table: from a table.</source>
   <translation>equal (gleich): Jeder Wechsel zählt 1. code: hierarchische Codes wie die von CORINE; der Anteil der Ziffern ab der ersten verschiedenen (311 zu 312: 1/3). table: aus einer Tabelle.</translation>
  </message>
  <message>
   <source>exact aggregation, and focus maps</source>
   <translation>exakte Flächenaggregation und Fokuskarten</translation>
  </message>
  <message>
   <source>excluded class</source>
   <translation>ausgeschlossene Klasse</translation>
  </message>
  <message>
   <source>expression</source>
   <translation>Ausdruck</translation>
  </message>
  <message>
   <source>face {} between the lines</source>
   <translation>Masche {} zwischen den Linien</translation>
  </message>
  <message>
   <source>faster triangulation, and focus maps</source>
   <translation>schnellere Triangulation, und Fokuskarten</translation>
  </message>
  <message>
   <source>feature</source>
   <translation>Objekt</translation>
  </message>
  <message>
   <source>feature {}</source>
   <translation>Objekt {}</translation>
  </message>
  <message>
   <source>features</source>
   <translation>Objekte</translation>
  </message>
  <message>
   <source>file to write</source>
   <translation>Datei, die geschrieben wird</translation>
  </message>
  <message>
   <source>gap</source>
   <translation>Lücke</translation>
  </message>
  <message>
   <source>gaps</source>
   <translation>Lücken</translation>
  </message>
  <message>
   <source>goes on</source>
   <translation>geht weiter</translation>
  </message>
  <message>
   <source>greedy: quick. annealing: better the longer it runs. exact: best, for small maps.</source>
   <translation>greedy: schnell. annealing: umso besser, je länger es läuft. exact: am besten, für kleine Karten.</translation>
  </message>
  <message>
   <source>hole</source>
   <translation>Loch</translation>
  </message>
  <message>
   <source>holes</source>
   <translation>Löcher</translation>
  </message>
  <message>
   <source>in a terminal</source>
   <translation>in einem Terminal</translation>
  </message>
  <message>
   <source>in the OSGeo4W Shell</source>
   <translation>in der OSGeo4W-Shell</translation>
  </message>
  <message>
   <source>in the dialog</source>
   <translation>im Dialog</translation>
  </message>
  <message>
   <source>in the group {}</source>
   <translation>in der Gruppe {}</translation>
  </message>
  <message>
   <source>independent part</source>
   <translation>unabhängiger Teil</translation>
  </message>
  <message>
   <source>independent parts</source>
   <translation>unabhängige Teile</translation>
  </message>
  <message>
   <source>invalid geometry: {}</source>
   <translation>ungültige Geometrie: {}</translation>
  </message>
  <message>
   <source>it crosses the shorter line {}</source>
   <translation>sie kreuzt die kürzere Linie {}</translation>
  </message>
  <message>
   <source>it has coordinates that are not finite, or larger than {:g}</source>
   <translation>sie hat Koordinaten, die nicht endlich oder größer als {:g} sind</translation>
  </message>
  <message>
   <source>it has no class</source>
   <translation>sie hat keine Klasse</translation>
  </message>
  <message>
   <source>it has no geometry</source>
   <translation>die Geometrie fehlt</translation>
  </message>
  <message>
   <source>it is empty</source>
   <translation>die Geometrie ist leer</translation>
  </message>
  <message>
   <source>it is no polygon</source>
   <translation>es ist kein Polygon</translation>
  </message>
  <message>
   <source>it is not one straight line between two points</source>
   <translation>sie ist keine gerade Linie zwischen zwei Punkten</translation>
  </message>
  <message>
   <source>it is too fine to be checked</source>
   <translation>zu fein, um geprüft zu werden</translation>
  </message>
  <message>
   <source>it leaves its polygon</source>
   <translation>sie verlässt ihr Polygon</translation>
  </message>
  <message>
   <source>it must be a number of at least 0</source>
   <translation>es muss eine Zahl ab 0 sein</translation>
  </message>
  <message>
   <source>it repeats line {}</source>
   <translation>sie wiederholt Linie {}</translation>
  </message>
  <message>
   <source>it touches the boundary between its ends</source>
   <translation>sie berührt den Umriss zwischen ihren Enden</translation>
  </message>
  <message>
   <source>its class is excluded, and no other is possible here</source>
   <translation>ihre Klasse ist ausgeschlossen, und keine andere ist hier möglich</translation>
  </message>
  <message>
   <source>keep classes: as little as possible changes its class. compact: short boundaries, and areas near their region's core. balanced: between both.</source>
   <translation>keep classes: Möglichst wenig wechselt die Klasse. compact: kurze Grenzen, und Flächen nah am Kern ihrer Region. balanced: dazwischen.</translation>
  </message>
  <message>
   <source>largest part</source>
   <translation>größter Teil</translation>
  </message>
  <message>
   <source>layer</source>
   <translation>Layer</translation>
  </message>
  <message>
   <source>layer to write</source>
   <translation>Layer, der geschrieben wird</translation>
  </message>
  <message>
   <source>layers</source>
   <translation>Layer</translation>
  </message>
  <message>
   <source>length of the cuts</source>
   <translation>Länge der Schnitte</translation>
  </message>
  <message>
   <source>level</source>
   <translation>Stufe</translation>
  </message>
  <message>
   <source>levels</source>
   <translation>Stufen</translation>
  </message>
  <message>
   <source>line {}</source>
   <translation>Linie {}</translation>
  </message>
  <message>
   <source>lines of the map are too close to each other to be moved without a fold, near ({:g} {:g})</source>
   <translation>Linien der Karte liegen zu dicht beieinander, um ohne Falte verschoben zu werden, nahe ({:g} {:g})</translation>
  </message>
  <message>
   <source>lost</source>
   <translation>verloren</translation>
  </message>
  <message>
   <source>most of its lines are no longer than a point</source>
   <translation>sind die meisten ihrer Linien nicht länger als ein Punkt</translation>
  </message>
  <message>
   <source>name</source>
   <translation>Name</translation>
  </message>
  <message>
   <source>name of a field</source>
   <translation>Name eines Feldes</translation>
  </message>
  <message>
   <source>no class</source>
   <translation>keine Klasse</translation>
  </message>
  <message>
   <source>no number</source>
   <translation>keine Zahl</translation>
  </message>
  <message>
   <source>none (optional)</source>
   <translation>keine (optional)</translation>
  </message>
  <message>
   <source>not contiguous</source>
   <translation>nicht zusammenhängend</translation>
  </message>
  <message>
   <source>not for commercial use</source>
   <translation>nicht für kommerzielle Nutzung</translation>
  </message>
  <message>
   <source>nothing may be written to the folder {}</source>
   <translation>in den Ordner {} darf nichts geschrieben werden</translation>
  </message>
  <message>
   <source>number</source>
   <translation>Zahl</translation>
  </message>
  <message>
   <source>number of cuts</source>
   <translation>Anzahl der Schnitte</translation>
  </message>
  <message>
   <source>off by default</source>
   <translation>nur auf Wunsch</translation>
  </message>
  <message>
   <source>optional</source>
   <translation>optional</translation>
  </message>
  <message>
   <source>or</source>
   <translation>oder</translation>
  </message>
  <message>
   <source>pair</source>
   <translation>Paar</translation>
  </message>
  <message>
   <source>pairs</source>
   <translation>Paare</translation>
  </message>
  <message>
   <source>part</source>
   <translation>Teil</translation>
  </message>
  <message>
   <source>parts</source>
   <translation>Teile</translation>
  </message>
  <message>
   <source>parts of the focus are one point</source>
   <translation>fallen Teile der Region in einen Punkt</translation>
  </message>
  <message>
   <source>place</source>
   <translation>Stelle</translation>
  </message>
  <message>
   <source>places</source>
   <translation>Stellen</translation>
  </message>
  <message>
   <source>point</source>
   <translation>Punkt</translation>
  </message>
  <message>
   <source>points</source>
   <translation>Punkte</translation>
  </message>
  <message>
   <source>polygon {}</source>
   <translation>Polygon {}</translation>
  </message>
  <message>
   <source>programme</source>
   <translation>Programm</translation>
  </message>
  <message>
   <source>programmes</source>
   <translation>Programme</translation>
  </message>
  <message>
   <source>region</source>
   <translation>Region</translation>
  </message>
  <message>
   <source>region {}</source>
   <translation>Region {}</translation>
  </message>
  <message>
   <source>regions</source>
   <translation>Regionen</translation>
  </message>
  <message>
   <source>regions: between all regions. classes: only between regions of different class.</source>
   <translation>regions: zwischen allen Regionen. classes: nur zwischen Regionen verschiedener Klasse.</translation>
  </message>
  <message>
   <source>shapely 2 is needed, and {} is installed</source>
   <translation>shapely 2 wird gebraucht, und {} ist installiert</translation>
  </message>
  <message>
   <source>share</source>
   <translation>Anteil</translation>
  </message>
  <message>
   <source>some coordinates are not finite (NaN or infinity)</source>
   <translation>einige Koordinaten sind nicht endlich (NaN oder unendlich)</translation>
  </message>
  <message>
   <source>tau = {tau:g}</source>
   <translation>tau = {tau:g}</translation>
  </message>
  <message>
   <source>tau must be a number from 1 to below {:g}, and is {}</source>
   <translation>tau muss eine Zahl von 1 bis unter {:g} sein und ist {}</translation>
  </message>
  <message>
   <source>tau must be a number of at least 1, and is {}</source>
   <translation>tau muss eine Zahl ab 1 sein und ist {}</translation>
  </message>
  <message>
   <source>tau: largest detour allowed</source>
   <translation>tau: größter erlaubter Umweg</translation>
  </message>
  <message>
   <source>text</source>
   <translation>Text</translation>
  </message>
  <message>
   <source>the Python package shapely is missing</source>
   <translation>das Python-Paket shapely fehlt</translation>
  </message>
  <message>
   <source>the budget must be a number of at least 0, and is {}</source>
   <translation>das Budget muss eine Zahl ab 0 sein und ist {}</translation>
  </message>
  <message>
   <source>the budget of {:g} cannot be met: the least possible cost is {:.12g}, for the cuts that connect holes</source>
   <translation>das Budget von {:g} reicht nicht: Die geringsten möglichen Kosten sind {:.12g}, für die Schnitte, die Löcher anschließen</translation>
  </message>
  <message>
   <source>the candidate diagonals do not connect {} of {} holes to the rest</source>
   <translation>die möglichen Schnitte verbinden {} von {} Löchern nicht mit dem Rest</translation>
  </message>
  <message>
   <source>the class field</source>
   <translation>das Klassenfeld</translation>
  </message>
  <message>
   <source>the coordinates are too large: they reach from {} to {}</source>
   <translation>die Koordinaten sind zu groß: sie reichen von {} bis {}</translation>
  </message>
  <message>
   <source>the environment variable {} asks for {!r}, which is not installed</source>
   <translation>die Umgebungsvariable {} verlangt {!r}, das nicht installiert ist</translation>
  </message>
  <message>
   <source>the exact method needs the solver HiGHS from the Python package scipy, 1.9 or newer</source>
   <translation>das exakte Verfahren braucht den Löser HiGHS aus dem Python-Paket scipy, 1.9 oder neuer</translation>
  </message>
  <message>
   <source>the file there may not be changed</source>
   <translation>die Datei dort darf nicht geändert werden</translation>
  </message>
  <message>
   <source>the focus covers all of the input, so nothing can make room for it. Choose a smaller focus, or let the map grow</source>
   <translation>die Region bedeckt die ganze Karte, sodass nichts Platz machen kann. Wählen Sie eine kleinere Region, oder lassen Sie die Karte wachsen</translation>
  </message>
  <message>
   <source>the focus has no area</source>
   <translation>die Region hat keine Fläche</translation>
  </message>
  <message>
   <source>the focus is empty</source>
   <translation>die Region ist leer</translation>
  </message>
  <message>
   <source>the focus lies between lines that leave no room in it. Choose a larger region</source>
   <translation>die Region liegt zwischen Linien, die in ihr keinen Platz lassen. Wählen Sie eine größere Region</translation>
  </message>
  <message>
   <source>the focus touches nothing: no vertex, line or polygon of the input lies in it. Are the CRS of both layers right?</source>
   <translation>die Region berührt nichts: Kein Stützpunkt, keine Linie und kein Polygon der Karte liegt in ihr. Stimmen die KBS beider Layer?</translation>
  </message>
  <message>
   <source>the input has no coordinates</source>
   <translation>die Karte hat keine Koordinaten</translation>
  </message>
  <message>
   <source>the input {}</source>
   <translation>die Eingabe {}</translation>
  </message>
  <message>
   <source>the map could not be solved: some positions are not finite numbers</source>
   <translation>die Karte war nicht lösbar: einige Positionen sind keine endlichen Zahlen</translation>
  </message>
  <message>
   <source>the map could not be triangulated (too fine for double precision)</source>
   <translation>die Karte konnte nicht trianguliert werden (zu fein für doppelte Genauigkeit)</translation>
  </message>
  <message>
   <source>the map reaches as far as ({:g} {:g}), and compared with that, {}. Is this coordinate right?</source>
   <translation>die Karte reicht bis ({:g} {:g}), und damit verglichen {}. Stimmt diese Koordinate?</translation>
  </message>
  <message>
   <source>the package pythoncdt or triangle, or shapely 2.1 instead of {}, is needed</source>
   <translation>das Paket pythoncdt oder triangle wird gebraucht, oder shapely 2.1 statt {}</translation>
  </message>
  <message>
   <source>the polygon could not be triangulated (too fine for double precision)</source>
   <translation>das Polygon konnte nicht trianguliert werden (zu fein für doppelte Genauigkeit)</translation>
  </message>
  <message>
   <source>the result {}</source>
   <translation>das Ergebnis {}</translation>
  </message>
  <message>
   <source>the rings could not be connected (their touching is ambiguous)</source>
   <translation>die Ringe konnten nicht verbunden werden (wie sie sich berühren, ist nicht eindeutig)</translation>
  </message>
  <message>
   <source>the scale must be a number above 0, and is {:g}</source>
   <translation>die Vergrößerung muss eine Zahl über 0 sein und ist {:g}</translation>
  </message>
  <message>
   <source>the weight of candidate {} cannot be used: {}</source>
   <translation>das Gewicht des möglichen Schnitts {} ist nicht verwendbar: {}</translation>
  </message>
  <message>
   <source>there is no room for a scale of {:.10g}: it ends at {:g}. Choose a smaller scale, a larger map around the region, or let the map grow</source>
   <translation>für eine Vergrößerung von {:.10g} ist kein Platz: bei {:g} ist Schluss. Wählen Sie eine kleinere oder eine größere Karte um die Region, oder lassen Sie die Karte wachsen</translation>
  </message>
  <message>
   <source>too small</source>
   <translation>zu klein</translation>
  </message>
  <message>
   <source>tool</source>
   <translation>Werkzeug</translation>
  </message>
  <message>
   <source>total</source>
   <translation>gesamt</translation>
  </message>
  <message>
   <source>triangle's licence does not allow commercial use: leave it out then; </source>
   <translation>die Lizenz von triangle erlaubt keine kommerzielle Nutzung: lassen Sie es dann weg; </translation>
  </message>
  <message>
   <source>triangulation, and focus maps</source>
   <translation>Triangulation und Fokuskarten</translation>
  </message>
  <message>
   <source>true or false</source>
   <translation>true oder false</translation>
  </message>
  <message>
   <source>weight</source>
   <translation>Gewicht</translation>
  </message>
  <message>
   <source>what</source>
   <translation>was</translation>
  </message>
  <message>
   <source>whole</source>
   <translation>ganzzahlig</translation>
  </message>
  <message>
   <source>whole number</source>
   <translation>ganze Zahl</translation>
  </message>
  <message>
   <source>{lists}</source>
   <translation>{lists}</translation>
  </message>
  <message>
   <source>{} (feature {})</source>
   <translation>{} (Objekt {})</translation>
  </message>
  <message>
   <source>{} (gap {:.2f} %; {}, {} solved).</source>
   <translation>{} (Abstand {:.2f} %; {}; gelöst: {}).</translation>
  </message>
  <message>
   <source>{} ({}, {} ha)</source>
   <translation>{} ({}, {} ha)</translation>
  </message>
  <message>
   <source>{} and {}</source>
   <translation>{} und {}</translation>
  </message>
  <message>
   <source>{} cannot be reached: {}. Nothing was changed. Is there a network, and has QGIS its proxy (Settings, Options, Network)?</source>
   <translation>{} ist nicht erreichbar: {}. Es wurde nichts geändert. Gibt es ein Netz, und kennt QGIS den Proxy (Einstellungen, Optionen, Netzwerk)?</translation>
  </message>
  <message>
   <source>{} cannot be written to {}: there is no such folder. {}</source>
   <translation>{} kann nicht nach {} geschrieben werden: den Ordner gibt es nicht. {}</translation>
  </message>
  <message>
   <source>{} cannot be written to {}: {}. Choose another place.</source>
   <translation>{} kann nicht nach {} geschrieben werden: {}. Wählen Sie einen anderen Ort.</translation>
  </message>
  <message>
   <source>{} cannot be written: {}</source>
   <translation>{} kann nicht geschrieben werden: {}</translation>
  </message>
  <message>
   <source>{} cannot have so many or so few parts (PARTS), and got the next best number. A smaller TAU gives more cuts to choose from.</source>
   <translation>So viele oder so wenige Teile (PARTS) sind nicht möglich für {}; dort ist es die nächstbeste Anzahl. Ein kleineres TAU gibt mehr Schnitte zur Auswahl.</translation>
  </message>
  <message>
   <source>{} class distances are listed in one direction only; the other way they are taken as equal.</source>
   <translation>{} Klassenabstände sind nur in einer Richtung angegeben; in der anderen gelten sie als gleich.</translation>
  </message>
  <message>
   <source>{} could not be written to {} as a whole. Is the disk full?</source>
   <translation>{} konnte nicht vollständig nach {} geschrieben werden. Ist der Datenträger voll?</translation>
  </message>
  <message>
   <source>{} has come damaged: its checksum is wrong. Nothing was changed. Try again.</source>
   <translation>{} ist beschädigt angekommen: Die Prüfsumme stimmt nicht. Es wurde nichts geändert. Versuchen Sie es noch einmal.</translation>
  </message>
  <message>
   <source>{} in at most {} of a feature, made by {}.</source>
   <translation>{} in höchstens {} je Objekt, durch {}.</translation>
  </message>
  <message>
   <source>{} in {}, by {}.</source>
   <translation>{} in {}, Verfahren: {}.</translation>
  </message>
  <message>
   <source>{} inside the map without an area, at {}{}. Areas on both sides of a gap are no neighbours there.</source>
   <translation>{} ohne Fläche in der Karte, bei {}{}. Flächen beiderseits einer Lücke sind dort keine Nachbarn.</translation>
  </message>
  <message>
   <source>{} is no folder</source>
   <translation>{} ist kein Ordner</translation>
  </message>
  <message>
   <source>{} is no number of at least 0: {}.</source>
   <translation>{} ist keine Zahl ab 0: {}.</translation>
  </message>
  <message>
   <source>{} is not as expected, and was not unpacked.</source>
   <translation>{} ist nicht wie erwartet und wurde nicht ausgepackt.</translation>
  </message>
  <message>
   <source>{} must be a layer of the type {}, and is of the type {}.</source>
   <translation>{} muss ein Layer vom Typ {} sein und ist vom Typ {}.</translation>
  </message>
  <message>
   <source>{} must be a number from 0 on, and is {}</source>
   <translation>{} muss eine Zahl ab 0 sein und ist {}</translation>
  </message>
  <message>
   <source>{} must be a number from 0 to {:g}, and is {}</source>
   <translation>{} muss eine Zahl von 0 bis {:g} sein und ist {}</translation>
  </message>
  <message>
   <source>{} must be a number of at least {:g}, and is {:g}.</source>
   <translation>{} muss eine Zahl ab {:g} sein und ist {:g}.</translation>
  </message>
  <message>
   <source>{} must be a number, and is {!r}.</source>
   <translation>{} muss eine Zahl sein und ist {!r}.</translation>
  </message>
  <message>
   <source>{} must be a whole number, and is {}.</source>
   <translation>{} muss eine ganze Zahl sein und ist {}.</translation>
  </message>
  <message>
   <source>{} must be at most {:g}, and is {:g}.</source>
   <translation>{} darf höchstens {:g} sein und ist {:g}.</translation>
  </message>
  <message>
   <source>{} must be one of {} (or its number, 0 to {}), and is {!r}.</source>
   <translation>{} muss eines von {} sein (oder dessen Nummer, 0 bis {}) und ist {!r}.</translation>
  </message>
  <message>
   <source>{} must not be negative, and is {:g}.</source>
   <translation>{} darf nicht negativ sein und ist {:g}.</translation>
  </message>
  <message>
   <source>{} of areas overlap: {}{}. Nothing was changed about that; sizes count the common part twice.</source>
   <translation>Überlappende Flächen: {}: {}{}. Daran wurde nichts geändert; die Größen zählen den gemeinsamen Teil doppelt.</translation>
  </message>
  <message>
   <source>{} of each feature</source>
   <translation>{} je Objekt</translation>
  </message>
  <message>
   <source>{} of {} relevant edges were left out: an end is not a point of the map.</source>
   <translation>{} von {} relevanten Kanten wurden weggelassen: Ein Ende ist kein Punkt der Karte.</translation>
  </message>
  <message>
   <source>{} regions were wanted, and {} is as near as thresholds and neighbours allowed by merging and splitting single regions.</source>
   <translation>{} Regionen waren gewünscht; näher als {} ließen Mindestgrößen und Nachbarn beim Verschmelzen und Teilen einzelner Regionen nicht zu.</translation>
  </message>
  <message>
   <source>{} smaller than 1 per cent of the feature.</source>
   <translation>{} kleiner als 1 Prozent des Objekts.</translation>
  </message>
  <message>
   <source>{} squares are no longer convex, as there was no room. Nothing crosses there.</source>
   <translation>{} Quadrate sind nicht mehr konvex, da kein Platz war. Dort kreuzt sich nichts.</translation>
  </message>
  <message>
   <source>{} would overwrite {}: both are {}. Choose another file{}.</source>
   <translation>{} würde {} überschreiben: beide sind {}. Wählen Sie eine andere Datei{}.</translation>
  </message>
  <message>
   <source>{} {} is in {}</source>
   <translation>{} {} liegt in {}</translation>
  </message>
  <message>
   <source>{}, made by {} of {} in all. The largest detour left is {:.4g}.</source>
   <translation>{}, durch {} von insgesamt {}. Der größte verbliebene Umweg ist {:.4g}.</translation>
  </message>
  <message>
   <source>{}, {:.1f} MB, from {}</source>
   <translation>{}, {:.1f} MB, von {}</translation>
  </message>
  <message>
   <source>{}, {}. Now try it on a layer of yours: Plugins &gt; Isthmus.</source>
   <translation>{}, {}. Nun mit einem eigenen Layer: Erweiterungen &gt; Isthmus.</translation>
  </message>
  <message>
   <source>{}: features {}{} have no place in the CRS of the map, and are carried without a geometry.</source>
   <translation>{}: Die Objekte {}{} haben im KBS der Karte keinen Ort und werden ohne Geometrie übernommen.</translation>
  </message>
  <message>
   <source>{}: {}</source>
   <translation>{}: {}</translation>
  </message>
  <message>
   <source>{}: {} of {}</source>
   <translation>{}: {} von {}</translation>
  </message>
 </context>
</TS>
