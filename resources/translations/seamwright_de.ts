<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>About</name>
    <message>
        <source>About Seamwright</source>
        <translation>Über Seamwright</translation>
    </message>
    <message>
        <source>Robot path correction with laser-stripe sensors: calibrate, teach, align, prove, run.</source>
        <translation>Bahnkorrektur für Roboter mit Laser-Lichtschnitt-Sensoren: kalibrieren, einlernen, ausrichten, nachweisen, fahren.</translation>
    </message>
    <message>
        <source>Built on these libraries, and their licences:</source>
        <translation>Gebaut auf diesen Bibliotheken, und ihre Lizenzen:</translation>
    </message>
</context>
<context>
    <name>Checklist</name>
    <message>
        <source>measure the next part</source>
        <translation>das nächste Teil messen</translation>
    </message>
    <message>
        <source>first: %1</source>
        <translation>zuerst: %1</translation>
    </message>
    <message>
        <source>Cell</source>
        <translation>Zelle</translation>
    </message>
    <message>
        <source>Calibrate</source>
        <translation>Kalibrieren</translation>
    </message>
    <message>
        <source>Teach</source>
        <translation>Einlernen</translation>
    </message>
    <message>
        <source>Align</source>
        <translation>Ausrichten</translation>
    </message>
    <message>
        <source>Regions</source>
        <translation>Bereiche</translation>
    </message>
    <message>
        <source>Prove</source>
        <translation>Nachweisen</translation>
    </message>
    <message>
        <source>Run</source>
        <translation>Lauf</translation>
    </message>
    <message>
        <source>done</source>
        <translation>fertig</translation>
    </message>
    <message>
        <source>next</source>
        <translation>als Nächstes</translation>
    </message>
    <message>
        <source>waits</source>
        <translation>wartet</translation>
    </message>
    <message>
        <source>stale</source>
        <translation>veraltet</translation>
    </message>
    <message>
        <source>the studies that a customer asks for before the release</source>
        <translation>die Untersuchungen, die ein Kunde vor der Freigabe verlangt</translation>
    </message>
    <message>
        <source>Accept</source>
        <translation>Abnehmen</translation>
    </message>
    <message>
        <source>on request</source>
        <translation>auf Verlangen</translation>
    </message>
</context>
<context>
    <name>DeskCommand</name>
    <message>
        <source>spot</source>
        <translation>Messstelle</translation>
    </message>
    <message>
        <source>region</source>
        <translation>Korrekturbereich</translation>
    </message>
    <message>
        <source>sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>calibration</source>
        <translation>Kalibrierung</translation>
    </message>
    <message>
        <source>Enable spot %1</source>
        <translation>Messstelle %1 einschalten</translation>
    </message>
    <message>
        <source>Disable spot %1</source>
        <translation>Messstelle %1 ausschalten</translation>
    </message>
    <message>
        <source>Use calibration %1 at sensor %2</source>
        <translation>Kalibrierung %1 an Sensor %2 benutzen</translation>
    </message>
    <message>
        <source>Use calibration %1</source>
        <translation>Kalibrierung %1 benutzen</translation>
    </message>
    <message>
        <source>Keep calibration %1</source>
        <translation>Kalibrierung %1 behalten</translation>
    </message>
    <message>
        <source>Use calibrations %1</source>
        <translation>Kalibrierungen %1 benutzen</translation>
    </message>
    <message>
        <source>Keep calibrations %1</source>
        <translation>Kalibrierungen %1 behalten</translation>
    </message>
    <message>
        <source>Rename project to %1</source>
        <translation>Projekt in %1 umbenennen</translation>
    </message>
    <message>
        <source>Add %1 %2</source>
        <translation>%1 %2 hinzufügen</translation>
    </message>
    <message>
        <source>Remove %1 %2</source>
        <translation>%1 %2 entfernen</translation>
    </message>
    <message>
        <source>Rename %1 %2 to %3</source>
        <translation>%1 %2 in %3 umbenennen</translation>
    </message>
    <message>
        <source>Move %1 %2</source>
        <translation>%1 %2 verschieben</translation>
    </message>
    <message>
        <source>Change %1 %2</source>
        <translation>%1 %2 ändern</translation>
    </message>
    <message>
        <source>Change %3 of %1 %2</source>
        <translation>%3 von %1 %2 ändern</translation>
    </message>
    <message>
        <source>Import part %1</source>
        <translation>Teil %1 einlesen</translation>
    </message>
    <message>
        <source>Place the simulated part</source>
        <translation>Das simulierte Teil platzieren</translation>
    </message>
    <message>
        <source>Change the requirements</source>
        <translation>Forderungen ändern</translation>
    </message>
    <message>
        <source>Take up again after an exchange</source>
        <translation>Nach einem Austausch wieder aufnehmen</translation>
    </message>
</context>
<context>
    <name>MethodText</name>
    <message>
        <source>good</source>
        <translation>gut</translation>
    </message>
    <message>
        <source>usable</source>
        <translation>brauchbar</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>schlecht</translation>
    </message>
    <message>
        <source>undetermined</source>
        <translation>unbestimmt</translation>
    </message>
</context>
<context>
    <name>RecoveryText</name>
    <message>
        <source>%1 %2 added</source>
        <translation>%1 %2 hinzugefügt</translation>
    </message>
    <message>
        <source>%1 %2 changed</source>
        <translation>%1 %2 geändert</translation>
    </message>
    <message>
        <source>%1 %2 removed</source>
        <translation>%1 %2 entfernt</translation>
    </message>
    <message>
        <source>project renamed</source>
        <translation>Projekt umbenannt</translation>
    </message>
    <message>
        <source>part changed</source>
        <translation>Teil geändert</translation>
    </message>
    <message>
        <source>requirements changed</source>
        <translation>Anforderungen geändert</translation>
    </message>
    <message>
        <source>order changed</source>
        <translation>Reihenfolge geändert</translation>
    </message>
    <message>
        <source>The file that keeps unsaved edits went bad (%1). It was set aside as %2 and begun anew.</source>
        <translation>Die Datei mit den ungespeicherten Änderungen wurde unlesbar (%1). Sie wurde als %2 beiseitegelegt und neu begonnen.</translation>
    </message>
    <message>
        <source>Unsaved edits are not kept against a crash: %1</source>
        <translation>Ungespeicherte Änderungen sind nicht gegen einen Absturz gesichert: %1</translation>
    </message>
</context>
<context>
    <name>seamwright::PlaceDialog</name>
    <message>
        <source>%1 mm, %2</source>
        <translation>%1 mm, %2</translation>
    </message>
    <message>
        <source>fold of %1 degrees</source>
        <translation>Kante von %1 Grad</translation>
    </message>
    <message>
        <source>free border</source>
        <translation>freier Rand</translation>
    </message>
    <message>
        <source>smooth</source>
        <translation>glatt</translation>
    </message>
    <message>
        <source>Spots from the drawing</source>
        <translation>Messstellen aus der Zeichnung</translation>
    </message>
    <message>
        <source>Drawing</source>
        <translation>Zeichnung</translation>
    </message>
    <message>
        <source>STEP, IGES, STL, PLY or OBJ, in the work object</source>
        <translation>STEP, IGES, STL, PLY oder OBJ, im Werkobjekt</translation>
    </message>
    <message>
        <source>Choose the drawing...</source>
        <translation>Zeichnung wählen...</translation>
    </message>
    <message>
        <source>Edge of the bead</source>
        <translation>Kante der Raupe</translation>
    </message>
    <message>
        <source>The bead follows it. Or click it in the 3D view; spots stand along its chain of tangent edges.</source>
        <translation>Ihr folgt die Raupe. Oder in der 3D-Ansicht anklicken; Messstellen stehen entlang ihrer Kette tangentialer Kanten.</translation>
    </message>
    <message>
        <source>For the region</source>
        <translation>Für den Korrekturbereich</translation>
    </message>
    <message>
        <source>Its limits and free degrees hold, and it takes the spots</source>
        <translation>Ihre Grenzen und freien Grade gelten, und sie nimmt die Messstellen auf</translation>
    </message>
    <message>
        <source>Wanted 3 sigma</source>
        <translation>Gewünschte 3 Sigma</translation>
    </message>
    <message>
        <source>Across the bead, at its worst point</source>
        <translation>Quer zur Raupe, an ihrem schlechtesten Punkt</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>How many spots may be proposed</source>
        <translation>Wie viele Messstellen vorgeschlagen werden dürfen</translation>
    </message>
    <message>
        <source>Spots, at least</source>
        <translation>Messstellen, mindestens</translation>
    </message>
    <message>
        <source>Spots, at most</source>
        <translation>Messstellen, höchstens</translation>
    </message>
    <message>
        <source>Turned by up to</source>
        <translation>Gedreht um bis zu</translation>
    </message>
    <message>
        <source>The sensor about the edge; 0: the middle of the two faces alone</source>
        <translation>Der Sensor um die Kante; 0: nur die Mitte der beiden Flächen</translation>
    </message>
    <message>
        <source> degrees</source>
        <translation> Grad</translation>
    </message>
    <message>
        <source>Beyond its ends by up to</source>
        <translation>Über ihre Enden um bis zu</translation>
    </message>
    <message>
        <source>Of the edge, along its chain. A part that bends is measured best near its bead</source>
        <translation>Der Kante, entlang ihrer Kette. Ein Teil, das sich biegt, wird am besten nahe seiner Raupe gemessen</translation>
    </message>
    <message>
        <source>Noise of a point</source>
        <translation>Rauschen eines Punkts</translation>
    </message>
    <message>
        <source>Of a profile, one standard deviation</source>
        <translation>Eines Profils, eine Standardabweichung</translation>
    </message>
    <message>
        <source>Any single spot may be lost</source>
        <translation>Jede einzelne Messstelle darf ausfallen</translation>
    </message>
    <message>
        <source>The bead is known well enough without it too</source>
        <translation>Auch ohne sie ist die Raupe gut genug bekannt</translation>
    </message>
    <message>
        <source>Propose spots</source>
        <translation>Messstellen vorschlagen</translation>
    </message>
    <message>
        <source>The fewest that are enough, then the shortest way</source>
        <translation>Die wenigsten, die genügen, dann der kürzeste Weg</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Stops reading or proposing</source>
        <translation>Hält Lesen oder Vorschlagen an</translation>
    </message>
    <message>
        <source>Spot</source>
        <translation>Messstelle</translation>
    </message>
    <message>
        <source>Along, mm</source>
        <translation>Entlang, mm</translation>
    </message>
    <message>
        <source>Turned, degrees</source>
        <translation>Gedreht, Grad</translation>
    </message>
    <message>
        <source>Sigma, mm</source>
        <translation>Sigma, mm</translation>
    </message>
    <message>
        <source>Feature</source>
        <translation>Merkmal</translation>
    </message>
    <message>
        <source>In the order of the way; sigma of the feature, the larger one</source>
        <translation>In der Reihenfolge des Wegs; Sigma des Merkmals, das größere</translation>
    </message>
    <message>
        <source>Take them into the project</source>
        <translation>Ins Projekt übernehmen</translation>
    </message>
    <message>
        <source>From the drawing, not confirmed: nothing is pushed by them until they are measured</source>
        <translation>Aus der Zeichnung, nicht bestätigt: nichts wird mit ihnen übertragen, bis sie gemessen sind</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>The drawing leaves the scene</source>
        <translation>Die Zeichnung verlässt die Szene</translation>
    </message>
    <message>
        <source>a new one</source>
        <translation>eine neue</translation>
    </message>
    <message>
        <source>Choose the part&apos;s drawing.</source>
        <translation>Wählen Sie die Zeichnung des Teils.</translation>
    </message>
    <message>
        <source>Drawings (*.step *.stp *.iges *.igs *.stl *.ply *.obj);;All files (*)</source>
        <translation>Zeichnungen (*.step *.stp *.iges *.igs *.stl *.ply *.obj);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>The drawing has no edge that a bead could follow.</source>
        <translation>Die Zeichnung hat keine Kante, der eine Raupe folgen könnte.</translation>
    </message>
    <message>
        <source>Click the edge that the bead follows in the 3D view, or choose it from the list.</source>
        <translation>Klicken Sie in der 3D-Ansicht auf die Kante, der die Raupe folgt, oder wählen Sie sie aus der Liste.</translation>
    </message>
    <message>
        <source>%1 spots on %2 mm of way: 3 sigma %3 mm at the worst point of the bead, wanted %4</source>
        <translation>%1 Messstellen auf %2 mm Weg: 3 Sigma %3 mm am schlechtesten Punkt der Raupe, gewünscht %4</translation>
    </message>
    <message>
        <source>; %1 mm with the worst spot lost</source>
        <translation>; %1 mm, wenn die schlechteste Messstelle ausfällt</translation>
    </message>
    <message>
        <source>. No set of as many gets below %1 mm.</source>
        <translation>. Keine Auswahl von ebenso vielen kommt unter %1 mm.</translation>
    </message>
    <message>
        <source>Not enough: allow more spots, or a wider tolerance.</source>
        <translation>Nicht genug: mehr Messstellen oder eine weitere Toleranz zulassen.</translation>
    </message>
    <message>
        <source>%1 spots are in region %2, from the drawing: confirm each on the part (step Teach) before anything is pushed.</source>
        <translation>%1 Messstellen sind im Korrekturbereich %2, aus der Zeichnung: Bestätigen Sie jede am Teil (Schritt Einlernen), bevor etwas übertragen wird.</translation>
    </message>
    <message>
        <source>Back along the edge</source>
        <translation>An der Kante zurück</translation>
    </message>
    <message>
        <source>The chosen spot to the next free place; or drag its ghost in the 3D view</source>
        <translation>Die gewählte Messstelle an den nächsten freien Platz; oder ihren Geist in der 3D-Ansicht ziehen</translation>
    </message>
    <message>
        <source>On along the edge</source>
        <translation>An der Kante weiter</translation>
    </message>
</context>
<context>
    <name>seamwright::StripePanel</name>
    <message>
        <source>Stripe in the image</source>
        <translation>Streifen im Bild</translation>
    </message>
    <message>
        <source>Filter of the profile</source>
        <translation>Filter des Profils</translation>
    </message>
</context>
<context>
    <name>Words</name>
    <message>
        <source>Cut along</source>
        <translation>Geschnitten entlang</translation>
    </message>
    <message>
        <source>Middle of the stripe by</source>
        <translation>Mitte des Streifens durch</translation>
    </message>
    <message>
        <source>Peaks a line</source>
        <translation>Maxima je Zeile</translation>
    </message>
    <message>
        <source>Least height of a peak</source>
        <translation>Mindesthöhe eines Maximums</translation>
    </message>
    <message>
        <source>Least width of a peak</source>
        <translation>Mindestbreite eines Maximums</translation>
    </message>
    <message>
        <source>Largest width of a peak</source>
        <translation>Größte Breite eines Maximums</translation>
    </message>
    <message>
        <source>Smoothing (Steger)</source>
        <translation>Glättung (Steger)</translation>
    </message>
    <message>
        <source>Noise of a point</source>
        <translation>Rauschen eines Punkts</translation>
    </message>
    <message>
        <source>Acceptance band, sigmas</source>
        <translation>Annahmeband, Sigma</translation>
    </message>
    <message>
        <source>Longest burst of outliers</source>
        <translation>Längste Folge von Ausreißern</translation>
    </message>
    <message>
        <source>Weight of the newest point</source>
        <translation>Gewicht des neuesten Punkts</translation>
    </message>
    <message>
        <source>First sigma of the spacing</source>
        <translation>Anfängliches Sigma des Abstands</translation>
    </message>
    <message>
        <source>Shortest segment, points</source>
        <translation>Kürzestes Segment, Punkte</translation>
    </message>
    <message>
        <source>As the sensor delivers it</source>
        <translation>Wie vom Sensor geliefert</translation>
    </message>
    <message>
        <source>centre of gravity</source>
        <translation>Schwerpunkt</translation>
    </message>
    <message>
        <source>Gaussian curve</source>
        <translation>Gauß-Kurve</translation>
    </message>
    <message>
        <source>ridge (Steger)</source>
        <translation>Grat (Steger)</translation>
    </message>
    <message>
        <source>Side</source>
        <translation>Seite</translation>
    </message>
    <message>
        <source>Segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>Least points</source>
        <translation>Mindestpunkte</translation>
    </message>
    <message>
        <source>Fitted length</source>
        <translation>Anpasslänge</translation>
    </message>
    <message>
        <source>Split</source>
        <translation>Teilung</translation>
    </message>
    <message>
        <source>Left line, x from</source>
        <translation>Linke Linie, x von</translation>
    </message>
    <message>
        <source>Left line, x to</source>
        <translation>Linke Linie, x bis</translation>
    </message>
    <message>
        <source>Right line, x from</source>
        <translation>Rechte Linie, x von</translation>
    </message>
    <message>
        <source>Right line, x to</source>
        <translation>Rechte Linie, x bis</translation>
    </message>
    <message>
        <source>Length of lines</source>
        <translation>Länge der Linien</translation>
    </message>
    <message>
        <source>Blend left out</source>
        <translation>Ausgelassene Rundung</translation>
    </message>
    <message>
        <source>Least angle</source>
        <translation>Kleinster Winkel</translation>
    </message>
    <message>
        <source>Radius</source>
        <translation>Radius</translation>
    </message>
    <message>
        <source>Least radius</source>
        <translation>Kleinster Radius</translation>
    </message>
    <message>
        <source>Largest radius</source>
        <translation>Größter Radius</translation>
    </message>
    <message>
        <source>Least arc</source>
        <translation>Kleinster Bogen</translation>
    </message>
    <message>
        <source>Which one</source>
        <translation>Welches</translation>
    </message>
    <message>
        <source>Window, x from</source>
        <translation>Fenster, x von</translation>
    </message>
    <message>
        <source>Window, x to</source>
        <translation>Fenster, x bis</translation>
    </message>
    <message>
        <source>Window, z from</source>
        <translation>Fenster, z von</translation>
    </message>
    <message>
        <source>Window, z to</source>
        <translation>Fenster, z bis</translation>
    </message>
    <message>
        <source>Search along x</source>
        <translation>Suche entlang x</translation>
    </message>
    <message>
        <source>Search along z</source>
        <translation>Suche entlang z</translation>
    </message>
    <message>
        <source>Search in angle</source>
        <translation>Suche im Winkel</translation>
    </message>
    <message>
        <source>Least share seen</source>
        <translation>Mindestanteil</translation>
    </message>
    <message>
        <source>Entry</source>
        <translation>Einfahrt</translation>
    </message>
    <message>
        <source>Exit</source>
        <translation>Ausfahrt</translation>
    </message>
    <message>
        <source>Speed</source>
        <translation>Geschwindigkeit</translation>
    </message>
    <message>
        <source>Sigma</source>
        <translation>Sigma</translation>
    </message>
    <message>
        <source>Trigger jitter</source>
        <translation>Triggerstreuung</translation>
    </message>
    <message>
        <source>Weight of X</source>
        <translation>Gewicht von X</translation>
    </message>
    <message>
        <source>Weight of Y</source>
        <translation>Gewicht von Y</translation>
    </message>
    <message>
        <source>Weight of Z</source>
        <translation>Gewicht von Z</translation>
    </message>
    <message>
        <source>Largest shift</source>
        <translation>Größter Versatz</translation>
    </message>
    <message>
        <source>Largest turn</source>
        <translation>Größte Drehung</translation>
    </message>
    <message>
        <source>Largest sigma, shift</source>
        <translation>Größtes Sigma, Versatz</translation>
    </message>
    <message>
        <source>Largest sigma, turn</source>
        <translation>Größtes Sigma, Drehung</translation>
    </message>
    <message>
        <source>Exposure</source>
        <translation>Belichtung</translation>
    </message>
    <message>
        <source>Gain</source>
        <translation>Verstärkung</translation>
    </message>
    <message>
        <source>Laser</source>
        <translation>Laser</translation>
    </message>
    <message>
        <source>Frame rate</source>
        <translation>Bildrate</translation>
    </message>
    <message>
        <source>Rate</source>
        <translation>Rate</translation>
    </message>
    <message>
        <source>Image region, x</source>
        <translation>Bildausschnitt, x</translation>
    </message>
    <message>
        <source>Image region, y</source>
        <translation>Bildausschnitt, y</translation>
    </message>
    <message>
        <source>Image region, width</source>
        <translation>Bildausschnitt, Breite</translation>
    </message>
    <message>
        <source>Image region, height</source>
        <translation>Bildausschnitt, Höhe</translation>
    </message>
    <message>
        <source>Pixel format</source>
        <translation>Pixelformat</translation>
    </message>
    <message>
        <source>Trigger</source>
        <translation>Trigger</translation>
    </message>
    <message>
        <source>deg</source>
        <translation>Grad</translation>
    </message>
    <message>
        <source>us</source>
        <translation>µs</translation>
    </message>
    <message>
        <source>left</source>
        <translation>links</translation>
    </message>
    <message>
        <source>right</source>
        <translation>rechts</translation>
    </message>
    <message>
        <source>outermost</source>
        <translation>äußerstes</translation>
    </message>
    <message>
        <source>longest</source>
        <translation>längstes</translation>
    </message>
    <message>
        <source>highest</source>
        <translation>höchstes</translation>
    </message>
    <message>
        <source>lowest</source>
        <translation>tiefstes</translation>
    </message>
    <message>
        <source>leftmost</source>
        <translation>linkestes</translation>
    </message>
    <message>
        <source>rightmost</source>
        <translation>rechtestes</translation>
    </message>
    <message>
        <source>Counted from outside</source>
        <translation>Von außen gezählt</translation>
    </message>
    <message>
        <source>Sensor&apos;s field, x from</source>
        <translation>Feld des Sensors, x von</translation>
    </message>
    <message>
        <source>Sensor&apos;s field, x to</source>
        <translation>Feld des Sensors, x bis</translation>
    </message>
    <message>
        <source>Every line is listed</source>
        <translation>Jede Zeile ist enthalten</translation>
    </message>
    <message>
        <source>the only one</source>
        <translation>das einzige</translation>
    </message>
    <message>
        <source>sharpest</source>
        <translation>schärfstes</translation>
    </message>
    <message>
        <source>automatic</source>
        <translation>Automatik</translation>
    </message>
    <message>
        <source>given</source>
        <translation>vorgegeben</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>on</source>
        <translation>ein</translation>
    </message>
    <message>
        <source>free running</source>
        <translation>freilaufend</translation>
    </message>
    <message>
        <source>by software</source>
        <translation>durch Software</translation>
    </message>
    <message>
        <source>contour end</source>
        <translation>Konturende</translation>
    </message>
    <message>
        <source>corner</source>
        <translation>Ecke</translation>
    </message>
    <message>
        <source>circle</source>
        <translation>Kreis</translation>
    </message>
    <message>
        <source>extremum</source>
        <translation>Extremum</translation>
    </message>
    <message>
        <source>template</source>
        <translation>Vorlage</translation>
    </message>
    <message>
        <source>ok</source>
        <translation>ok</translation>
    </message>
    <message>
        <source>no points</source>
        <translation>keine Punkte</translation>
    </message>
    <message>
        <source>not found</source>
        <translation>nicht gefunden</translation>
    </message>
    <message>
        <source>ambiguous</source>
        <translation>mehrdeutig</translation>
    </message>
    <message>
        <source>ill-conditioned</source>
        <translation>schlecht bestimmt</translation>
    </message>
    <message>
        <source>measured</source>
        <translation>gemessen</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>nicht gemessen</translation>
    </message>
    <message>
        <source>damaged frame</source>
        <translation>Bild beschädigt</translation>
    </message>
    <message>
        <source>no stripe</source>
        <translation>kein Streifen</translation>
    </message>
    <message>
        <source>no calibration</source>
        <translation>keine Kalibrierung</translation>
    </message>
    <message>
        <source>no feature</source>
        <translation>kein Merkmal</translation>
    </message>
    <message>
        <source>not pushed</source>
        <translation>nicht übertragen</translation>
    </message>
    <message>
        <source>written, read back</source>
        <translation>geschrieben, rückgelesen</translation>
    </message>
    <message>
        <source>failed</source>
        <translation>fehlgeschlagen</translation>
    </message>
    <message>
        <source>old frame restored</source>
        <translation>alter Frame wiederhergestellt</translation>
    </message>
    <message>
        <source>NOT RESTORED</source>
        <translation>NICHT WIEDERHERGESTELLT</translation>
    </message>
    <message>
        <source>under-determined</source>
        <translation>unterbestimmt</translation>
    </message>
    <message>
        <source>over limit</source>
        <translation>über der Grenze</translation>
    </message>
    <message>
        <source>not converged</source>
        <translation>nicht konvergiert</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>unbekannt</translation>
    </message>
    <message>
        <source>manual, reduced (T1)</source>
        <translation>Hand, reduziert (T1)</translation>
    </message>
    <message>
        <source>manual, full speed (T2)</source>
        <translation>Hand, volles Tempo (T2)</translation>
    </message>
    <message>
        <source>external</source>
        <translation>extern</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>angehalten</translation>
    </message>
    <message>
        <source>fault</source>
        <translation>Störung</translation>
    </message>
    <message>
        <source>good</source>
        <translation>gut</translation>
    </message>
    <message>
        <source>usable</source>
        <translation>brauchbar</translation>
    </message>
    <message>
        <source>bad</source>
        <translation>schlecht</translation>
    </message>
    <message>
        <source>Number</source>
        <translation>Nummer</translation>
    </message>
    <message>
        <source>sensor&apos;s own point</source>
        <translation>Punkt des Sensors</translation>
    </message>
    <message>
        <source>chessboard</source>
        <translation>Schachbrett</translation>
    </message>
    <message>
        <source>circles</source>
        <translation>Kreise</translation>
    </message>
    <message>
        <source>ChArUco</source>
        <translation>ChArUco</translation>
    </message>
    <message>
        <source>AprilGrid</source>
        <translation>AprilGrid</translation>
    </message>
    <message>
        <source>found</source>
        <translation>gefunden</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <source>Seed</source>
        <translation>Startwert des Zufalls</translation>
    </message>
    <message>
        <source>Scene</source>
        <translation>Szene</translation>
    </message>
    <message>
        <source>Mesh</source>
        <translation>Netz</translation>
    </message>
    <message>
        <source>Mesh's unit</source>
        <translation>Einheit des Netzes</translation>
    </message>
    <message>
        <source>Base from work object</source>
        <translation>Basis aus Werkobjekt</translation>
    </message>
    <message>
        <source>Base from target</source>
        <translation>Basis aus Zielkörper</translation>
    </message>
    <message>
        <source>Flange from sensor</source>
        <translation>Flansch aus Sensor</translation>
    </message>
    <message>
        <source>Part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Displacement</source>
        <translation>Verschiebung</translation>
    </message>
    <message>
        <source>Bend</source>
        <translation>Biegung</translation>
    </message>
    <message>
        <source>Twist</source>
        <translation>Verwindung</translation>
    </message>
    <message>
        <source>Optics</source>
        <translation>Optik</translation>
    </message>
    <message>
        <source>Width</source>
        <translation>Breite</translation>
    </message>
    <message>
        <source>Height</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>Bit depth</source>
        <translation>Bittiefe</translation>
    </message>
    <message>
        <source>Stand-off</source>
        <translation>Arbeitsabstand</translation>
    </message>
    <message>
        <source>Triangulation angle</source>
        <translation>Triangulationswinkel</translation>
    </message>
    <message>
        <source>Field of view</source>
        <translation>Sichtfeld</translation>
    </message>
    <message>
        <source>Distortion k1</source>
        <translation>Verzeichnung k1</translation>
    </message>
    <message>
        <source>Distortion k2</source>
        <translation>Verzeichnung k2</translation>
    </message>
    <message>
        <source>Distortion p1</source>
        <translation>Verzeichnung p1</translation>
    </message>
    <message>
        <source>Distortion p2</source>
        <translation>Verzeichnung p2</translation>
    </message>
    <message>
        <source>Distortion k3</source>
        <translation>Verzeichnung k3</translation>
    </message>
    <message>
        <source>Laser line's width</source>
        <translation>Breite der Laserlinie</translation>
    </message>
    <message>
        <source>Laser fan</source>
        <translation>Laserfächer</translation>
    </message>
    <message>
        <source>Blur</source>
        <translation>Unschärfe</translation>
    </message>
    <message>
        <source>Blooming</source>
        <translation>Überstrahlen</translation>
    </message>
    <message>
        <source>Surface</source>
        <translation>Oberfläche</translation>
    </message>
    <message>
        <source>Diffuse reflection</source>
        <translation>Diffuse Reflexion</translation>
    </message>
    <message>
        <source>Gloss</source>
        <translation>Glanz</translation>
    </message>
    <message>
        <source>Exponent of the gloss</source>
        <translation>Exponent des Glanzes</translation>
    </message>
    <message>
        <source>Share of dark patches</source>
        <translation>Anteil dunkler Flecken</translation>
    </message>
    <message>
        <source>Diffuse reflection of the patches</source>
        <translation>Diffuse Reflexion der Flecken</translation>
    </message>
    <message>
        <source>Size of the patches</source>
        <translation>Größe der Flecken</translation>
    </message>
    <message>
        <source>Mirror</source>
        <translation>Spiegelung</translation>
    </message>
    <message>
        <source>Noise</source>
        <translation>Rauschen</translation>
    </message>
    <message>
        <source>Shot noise</source>
        <translation>Photonenrauschen</translation>
    </message>
    <message>
        <source>Read noise, electrons</source>
        <translation>Ausleserauschen, Elektronen</translation>
    </message>
    <message>
        <source>Speckle</source>
        <translation>Speckle</translation>
    </message>
    <message>
        <source>Daylight, electrons per ms</source>
        <translation>Tageslicht, Elektronen je ms</translation>
    </message>
    <message>
        <source>Chance of a stray reflection</source>
        <translation>Wahrscheinlichkeit eines Streureflexes</translation>
    </message>
    <message>
        <source>Chance of a damaged frame</source>
        <translation>Wahrscheinlichkeit eines beschädigten Bildes</translation>
    </message>
    <message>
        <source>Buffers</source>
        <translation>Puffer</translation>
    </message>
    <message>
        <source>Sphere's radius</source>
        <translation>Kugelradius</translation>
    </message>
    <message>
        <source>Serial number</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>Board</source>
        <translation>Tafel</translation>
    </message>
    <message>
        <source>Columns</source>
        <translation>Spalten</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>Zeilen</translation>
    </message>
    <message>
        <source>Pitch</source>
        <translation>Teilung</translation>
    </message>
    <message>
        <source>Drift</source>
        <translation>Drift</translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>Time constant, parts</source>
        <translation>Zeitkonstante, Teile</translation>
    </message>
    <message>
        <source>Time constant</source>
        <translation>Zeitkonstante</translation>
    </message>
    <message>
        <source>From part</source>
        <translation>Ab Teil</translation>
    </message>
    <message>
        <source>Knock</source>
        <translation>Stoß</translation>
    </message>
    <message>
        <source>Knock before part</source>
        <translation>Stoß vor Teil</translation>
    </message>
    <message>
        <source>Knock after</source>
        <translation>Stoß nach</translation>
    </message>
    <message>
        <source>Repeatability</source>
        <translation>Wiederholgenauigkeit</translation>
    </message>
    <message>
        <source>Repeatability, turn</source>
        <translation>Wiederholgenauigkeit, Drehung</translation>
    </message>
    <message>
        <source>Trigger latency</source>
        <translation>Triggerverzögerung</translation>
    </message>
    <message>
        <source>Operating mode</source>
        <translation>Betriebsart</translation>
    </message>
    <message>
        <source>Frames</source>
        <translation>Frames</translation>
    </message>
    <message>
        <source>Head</source>
        <translation>Kopf</translation>
    </message>
    <message>
        <source>Heads</source>
        <translation>Köpfe</translation>
    </message>
    <message>
        <source>Base from opening</source>
        <translation>Basis aus Öffnung</translation>
    </message>
    <message>
        <source>Gap</source>
        <translation>Spalt</translation>
    </message>
    <message>
        <source>Panel</source>
        <translation>Anbauteil</translation>
    </message>
    <message>
        <source>Body</source>
        <translation>Karosserie</translation>
    </message>
    <message>
        <source>File</source>
        <translation>Datei</translation>
    </message>
    <message>
        <source>Source</source>
        <translation>Quelle</translation>
    </message>
    <message>
        <source>Step by step</source>
        <translation>Schrittweise</translation>
    </message>
    <message>
        <source>Endless</source>
        <translation>Endlos</translation>
    </message>
    <message>
        <source>From frame</source>
        <translation>Ab Bild</translation>
    </message>
    <message>
        <source>Recorded time of arrival</source>
        <translation>Aufgezeichnete Ankunftszeit</translation>
    </message>
    <message>
        <source>Folder</source>
        <translation>Ordner</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>Poses needed</source>
        <translation>Posen nötig</translation>
    </message>
    <message>
        <source>Layout</source>
        <translation>Aufbau</translation>
    </message>
    <message>
        <source>Unit</source>
        <translation>Einheit</translation>
    </message>
    <message>
        <source>Poses</source>
        <translation>Posen</translation>
    </message>
    <message>
        <source>Pose convention</source>
        <translation>Posenkonvention</translation>
    </message>
    <message>
        <source>Unit of poses</source>
        <translation>Einheit der Posen</translation>
    </message>
    <message>
        <source>Angles of poses</source>
        <translation>Winkel der Posen</translation>
    </message>
    <message>
        <source>Colour channel</source>
        <translation>Farbkanal</translation>
    </message>
    <message>
        <source>Model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>Vendor</source>
        <translation>Hersteller</translation>
    </message>
    <message>
        <source>Takes frames</source>
        <translation>Nimmt Frames an</translation>
    </message>
    <message>
        <source>Brand</source>
        <translation>Marke</translation>
    </message>
    <message>
        <source>Address</source>
        <translation>Adresse</translation>
    </message>
    <message>
        <source>Name of the device</source>
        <translation>Name des Geräts</translation>
    </message>
    <message>
        <source>Addresses asked</source>
        <translation>Gefragte Adressen</translation>
    </message>
    <message>
        <source>Part of the image</source>
        <translation>Bildausschnitt</translation>
    </message>
    <message>
        <source>First column</source>
        <translation>Erste Spalte</translation>
    </message>
    <message>
        <source>First row</source>
        <translation>Erste Zeile</translation>
    </message>
    <message>
        <source>Triggered by the robot</source>
        <translation>Vom Roboter getriggert</translation>
    </message>
    <message>
        <source>Features of the camera</source>
        <translation>Merkmale der Kamera</translation>
    </message>
    <message>
        <source>Chunks</source>
        <translation>Chunks</translation>
    </message>
    <message>
        <source>Range image</source>
        <translation>Höhenbild</translation>
    </message>
    <message>
        <source>Scale of x</source>
        <translation>Maßstab x</translation>
    </message>
    <message>
        <source>Offset of x</source>
        <translation>Versatz x</translation>
    </message>
    <message>
        <source>Scale of z</source>
        <translation>Maßstab z</translation>
    </message>
    <message>
        <source>Offset of z</source>
        <translation>Versatz z</translation>
    </message>
    <message>
        <source>Value without return</source>
        <translation>Wert ohne Echo</translation>
    </message>
    <message>
        <source>Packet size</source>
        <translation>Paketgröße</translation>
    </message>
    <message>
        <source>Kernel ring for packets</source>
        <translation>Ringpuffer des Kernels</translation>
    </message>
    <message>
        <source>Lost packets asked again</source>
        <translation>Verlorene Pakete nachfordern</translation>
    </message>
    <message>
        <source>Time-out of a packet</source>
        <translation>Zeitgrenze eines Pakets</translation>
    </message>
    <message>
        <source>Time-out of a frame</source>
        <translation>Zeitgrenze eines Bildes</translation>
    </message>
    <message>
        <source>Socket buffer</source>
        <translation>Socketpuffer</translation>
    </message>
    <message>
        <source>Time-out</source>
        <translation>Zeitgrenze</translation>
    </message>
    <message>
        <source>Heartbeat</source>
        <translation>Lebenszeichen</translation>
    </message>
    <message>
        <source>First wait to reconnect</source>
        <translation>Erste Wartezeit zum Neuverbinden</translation>
    </message>
    <message>
        <source>Longest wait to reconnect</source>
        <translation>Längste Wartezeit zum Neuverbinden</translation>
    </message>
    <message>
        <source>Port of commands</source>
        <translation>Port der Befehle</translation>
    </message>
    <message>
        <source>Output</source>
        <translation>Ausgabe</translation>
    </message>
    <message>
        <source>Port of data</source>
        <translation>Port der Daten</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>Format</source>
        <translation>Format</translation>
    </message>
    <message>
        <source>Delimiter</source>
        <translation>Trennzeichen</translation>
    </message>
    <message>
        <source>End of line</source>
        <translation>Zeilenende</translation>
    </message>
    <message>
        <source>Time-out of the start</source>
        <translation>Zeitgrenze des Starts</translation>
    </message>
    <message>
        <source>Listens on</source>
        <translation>Horcht auf</translation>
    </message>
    <message>
        <source>Port</source>
        <translation>Port</translation>
    </message>
    <message>
        <source>Robot's address</source>
        <translation>Adresse des Roboters</translation>
    </message>
    <message>
        <source>Trigger output</source>
        <translation>Triggerausgang</translation>
    </message>
    <message>
        <source>Flag of the connection</source>
        <translation>Flag der Verbindung</translation>
    </message>
    <message>
        <source>Flag of commands</source>
        <translation>Flag der Befehle</translation>
    </message>
    <message>
        <source>Looks every</source>
        <translation>Fragt alle</translation>
    </message>
    <message>
        <source>Cycle</source>
        <translation>Takt</translation>
    </message>
    <message>
        <source>Time-out of a ramp</source>
        <translation>Zeitgrenze einer Rampe</translation>
    </message>
    <message>
        <source>Base from reference</source>
        <translation>Basis aus Bezug</translation>
    </message>
    <message>
        <source>Flange from TCP</source>
        <translation>Flansch aus TCP</translation>
    </message>
    <message>
        <source>Speed of turning</source>
        <translation>Drehgeschwindigkeit</translation>
    </message>
    <message>
        <source>Acceleration</source>
        <translation>Beschleunigung</translation>
    </message>
    <message>
        <source>Acceleration of turning</source>
        <translation>Drehbeschleunigung</translation>
    </message>
    <message>
        <source>Late packets allowed</source>
        <translation>Erlaubte verspätete Pakete</translation>
    </message>
    <message>
        <source>Silence that ends a session</source>
        <translation>Stille, die eine Sitzung beendet</translation>
    </message>
    <message>
        <source>Fastest path</source>
        <translation>Schnellste Bahn</translation>
    </message>
    <message>
        <source>Following tolerance</source>
        <translation>Schlepptoleranz</translation>
    </message>
    <message>
        <source>Following tolerance, turn</source>
        <translation>Schlepptoleranz, Drehung</translation>
    </message>
    <message>
        <source>May miss it for</source>
        <translation>Darf sie verfehlen für</translation>
    </message>
    <message>
        <source>Measuring program</source>
        <translation>Messprogramm</translation>
    </message>
    <message>
        <source>Driver</source>
        <translation>Treiber</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Reference frame</source>
        <translation>Bezugsframe</translation>
    </message>
    <message>
        <source>SENTYPE</source>
        <translation>SENTYPE</translation>
    </message>
    <message>
        <source>Decimals</source>
        <translation>Nachkommastellen</translation>
    </message>
    <message>
        <source>Output: path runs</source>
        <translation>Ausgang: Bahn läuft</translation>
    </message>
    <message>
        <source>Output: path released</source>
        <translation>Ausgang: Bahn freigegeben</translation>
    </message>
    <message>
        <source>Port of the dashboard</source>
        <translation>Port des Dashboards</translation>
    </message>
    <message>
        <source>Time-out of a move</source>
        <translation>Zeitgrenze einer Bewegung</translation>
    </message>
    <message>
        <source>Frequency</source>
        <translation>Frequenz</translation>
    </message>
    <message>
        <source>First register</source>
        <translation>Erstes Register</translation>
    </message>
    <message>
        <source>Tool</source>
        <translation>Werkzeug</translation>
    </message>
    <message>
        <source>Load</source>
        <translation>Last</translation>
    </message>
    <message>
        <source>Mass</source>
        <translation>Masse</translation>
    </message>
    <message>
        <source>Centre of gravity</source>
        <translation>Schwerpunkt</translation>
    </message>
    <message>
        <source>Inertia, kg m²</source>
        <translation>Trägheit, kg m²</translation>
    </message>
    <message>
        <source>Axes</source>
        <translation>Achsen</translation>
    </message>
    <message>
        <source>TCP from sensor</source>
        <translation>TCP aus Sensor</translation>
    </message>
    <message>
        <source>Line's address</source>
        <translation>Adresse der Linie</translation>
    </message>
    <message>
        <source>Unit ID</source>
        <translation>Gerätenummer</translation>
    </message>
    <message>
        <source>Connections</source>
        <translation>Verbindungen</translation>
    </message>
    <message>
        <source>Closed when idle for</source>
        <translation>Schließt bei Ruhe nach</translation>
    </message>
    <message>
        <source>Started by</source>
        <translation>Gestartet von</translation>
    </message>
    <message>
        <source>Time-out of a call</source>
        <translation>Zeitgrenze eines Aufrufs</translation>
    </message>
    <message>
        <source>Time-out of the start's end</source>
        <translation>Zeitgrenze für das Ende des Starts</translation>
    </message>
    <message>
        <source>Time-out of the heartbeat</source>
        <translation>Zeitgrenze des Lebenszeichens</translation>
    </message>
    <message>
        <source>Read from address</source>
        <translation>Liest ab Adresse</translation>
    </message>
    <message>
        <source>Written from address</source>
        <translation>Schreibt ab Adresse</translation>
    </message>
    <message>
        <source>Group</source>
        <translation>Gruppe</translation>
    </message>
    <message>
        <source>Station</source>
        <translation>Station</translation>
    </message>
    <message>
        <source>Client ID</source>
        <translation>Client-ID</translation>
    </message>
    <message>
        <source>User name</source>
        <translation>Benutzername</translation>
    </message>
    <message>
        <source>Variable with the password</source>
        <translation>Variable mit dem Passwort</translation>
    </message>
    <message>
        <source>File with the password</source>
        <translation>Datei mit dem Passwort</translation>
    </message>
    <message>
        <source>Encrypted</source>
        <translation>Verschlüsselt</translation>
    </message>
    <message>
        <source>Certificates of authorities</source>
        <translation>Zertifikate der Stellen</translation>
    </message>
    <message>
        <source>Own certificate</source>
        <translation>Eigenes Zertifikat</translation>
    </message>
    <message>
        <source>Key of the certificate</source>
        <translation>Schlüssel des Zertifikats</translation>
    </message>
    <message>
        <source>Keepalive</source>
        <translation>Lebenszeichen alle</translation>
    </message>
    <message>
        <source>Queue</source>
        <translation>Warteschlange</translation>
    </message>
    <message>
        <source>Base</source>
        <translation>Basis</translation>
    </message>
    <message>
        <source>blue</source>
        <translation>blau</translation>
    </message>
    <message>
        <source>green</source>
        <translation>grün</translation>
    </message>
    <message>
        <source>red</source>
        <translation>rot</translation>
    </message>
    <message>
        <source>red without white</source>
        <translation>Rot ohne Weiß</translation>
    </message>
    <message>
        <source>grey</source>
        <translation>grau</translation>
    </message>
    <message>
        <source>images</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>profiles</source>
        <translation>Profile</translation>
    </message>
    <message>
        <source>line</source>
        <translation>Linie</translation>
    </message>
    <message>
        <source>plate</source>
        <translation>Platte</translation>
    </message>
    <message>
        <source>sphere</source>
        <translation>Kugel</translation>
    </message>
    <message>
        <source>triangular body</source>
        <translation>Dreieckkörper</translation>
    </message>
    <message>
        <source>path</source>
        <translation>Bahn</translation>
    </message>
    <message>
        <source>absolute</source>
        <translation>absolut</translation>
    </message>
    <message>
        <source>relative</source>
        <translation>relativ</translation>
    </message>
    <message>
        <source>ASCII</source>
        <translation>ASCII</translation>
    </message>
    <message>
        <source>days</source>
        <translation>Tage</translation>
    </message>
</context>
<context>
    <name>main</name>
    <message>
        <source>Teach, align, prove and run robot path correction with laser-stripe sensors.</source>
        <translation>Roboterbahnkorrektur mit Laserlichtschnittsensoren einlernen, ausrichten, nachweisen und betreiben.</translation>
    </message>
    <message>
        <source>project to open; without it the demo project</source>
        <translation>zu öffnendes Projekt; ohne Angabe das Demoprojekt</translation>
    </message>
    <message>
        <source>en or de</source>
        <translation>en oder de</translation>
    </message>
    <message>
        <source>light or dark</source>
        <translation>light (hell) oder dark (dunkel)</translation>
    </message>
    <message>
        <source>of the window, e.g. 1280x800</source>
        <translation>des Fensters, z. B. 1280x800</translation>
    </message>
    <message>
        <source>settings file instead of the user&apos;s</source>
        <translation>Einstellungsdatei statt der des Benutzers</translation>
    </message>
    <message>
        <source>folder for the demo project</source>
        <translation>Ordner für das Demoprojekt</translation>
    </message>
    <message>
        <source>writes a picture of the window after 3 s and ends</source>
        <translation>schreibt nach 3 s ein Bild des Fensters und endet</translation>
    </message>
    <message>
        <source>step to show, 1 to 8</source>
        <translation>gezeigter Schritt, 1 bis 8</translation>
    </message>
</context>
<context>
    <name>seamwright::AcceptPage</name>
    <message>
        <source>Is the measuring process good enough for the tolerance? Each study of the release, as AIAG MSA, VDA 5 and ISO 22514-7 ask for it, of the bead&apos;s deviation across its path.</source>
        <translation>Ist der Messprozess gut genug für die Toleranz? Jede Untersuchung der Freigabe, wie AIAG MSA, VDA 5 und ISO 22514-7 sie verlangen, an der Abweichung der Raupe quer zu ihrer Bahn.</translation>
    </message>
    <message>
        <source>Put in part %1, time %2</source>
        <translation>Teil %1 einlegen, zum %2. Mal</translation>
    </message>
    <message>
        <source>Region</source>
        <translation>Korrekturbereich</translation>
    </message>
    <message>
        <source>The region whose measuring process is studied</source>
        <translation>Der Korrekturbereich, dessen Messprozess untersucht wird</translation>
    </message>
    <message>
        <source>Next</source>
        <translation>Weiter</translation>
    </message>
    <message>
        <source>What comes next in the acceptance</source>
        <translation>Was in der Abnahme als Nächstes kommt</translation>
    </message>
    <message>
        <source>It stands</source>
        <translation>Es liegt</translation>
    </message>
    <message>
        <source>Measure this part</source>
        <translation>Dieses Teil messen</translation>
    </message>
    <message>
        <source>Later</source>
        <translation>Später</translation>
    </message>
    <message>
        <source>The study waits; it goes on from here another time</source>
        <translation>Die Untersuchung wartet und geht ein andermal von hier weiter</translation>
    </message>
    <message>
        <source>Studies</source>
        <translation>Untersuchungen</translation>
    </message>
    <message>
        <source>Study</source>
        <translation>Untersuchung</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Stand</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>Every study, how far it is and what came of it</source>
        <translation>Jede Untersuchung, wie weit sie ist und was sie ergab</translation>
    </message>
    <message>
        <source>Runs</source>
        <translation>Läufe</translation>
    </message>
    <message>
        <source>How often each part is measured, each time it is put in</source>
        <translation>Wie oft jedes Teil je Einlegen gemessen wird</translation>
    </message>
    <message>
        <source>Put in</source>
        <translation>Einlegen</translation>
    </message>
    <message>
        <source>How often each part is put in</source>
        <translation>Wie oft jedes Teil eingelegt wird</translation>
    </message>
    <message>
        <source>Parts</source>
        <translation>Teile</translation>
    </message>
    <message>
        <source>Names of the parts, separated by commas, in their order</source>
        <translation>Namen der Teile, durch Kommas getrennt, in ihrer Reihenfolge</translation>
    </message>
    <message>
        <source> deg</source>
        <translation> °</translation>
    </message>
    <message>
        <source>Travel turned by</source>
        <translation>Fahrt gedreht um</translation>
    </message>
    <message>
        <source>From the sensor&apos;s Y towards its X, so that the pass crosses the contour; the way must be free</source>
        <translation>Von Y des Sensors zu seinem X hin, damit die Durchfahrt die Kontur kreuzt; der Weg muss frei sein</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Measures; nothing is written to the robot</source>
        <translation>Misst; dem Roboter wird nichts geschrieben</translation>
    </message>
    <message>
        <source>Begin anew</source>
        <translation>Neu beginnen</translation>
    </message>
    <message>
        <source>Measures the whole study again, whatever was measured; the old runs stay</source>
        <translation>Misst die ganze Untersuchung noch einmal, was immer gemessen wurde; die alten Läufe bleiben</translation>
    </message>
    <message>
        <source>In the charts</source>
        <translation>In den Diagrammen</translation>
    </message>
    <message>
        <source>Run chart, and histogram with the tolerance, in the charts beside</source>
        <translation>Werteverlauf und Histogramm mit der Toleranz in den Diagrammen daneben</translation>
    </message>
    <message>
        <source>Requirements</source>
        <translation>Forderungen</translation>
    </message>
    <message>
        <source>The customer&apos;s. They are kept in the project, and no run depends on them.</source>
        <translation>Die des Kunden. Sie stehen im Projekt, und kein Lauf hängt von ihnen ab.</translation>
    </message>
    <message>
        <source>Tolerance T</source>
        <translation>Toleranz T</translation>
    </message>
    <message>
        <source>Middle of the tolerance</source>
        <translation>Mitte der Toleranz</translation>
    </message>
    <message>
        <source>Share of T in Cg</source>
        <translation>Anteil von T in Cg</translation>
    </message>
    <message>
        <source>Sigmas in Cg</source>
        <translation>Sigmas in Cg</translation>
    </message>
    <message>
        <source>Cg, at least</source>
        <translation>Cg, mindestens</translation>
    </message>
    <message>
        <source>Cgk, at least</source>
        <translation>Cgk, mindestens</translation>
    </message>
    <message>
        <source>%GRR accepted</source>
        <translation>%GRR, angenommen bis</translation>
    </message>
    <message>
        <source>%GRR refused beyond</source>
        <translation>%GRR, abgelehnt über</translation>
    </message>
    <message>
        <source>ndc, at least</source>
        <translation>ndc, mindestens</translation>
    </message>
    <message>
        <source>Q system, at most</source>
        <translation>Q System, höchstens</translation>
    </message>
    <message>
        <source>Q process, at most</source>
        <translation>Q Prozess, höchstens</translation>
    </message>
    <message>
        <source>Cg = %1 T / (%2 s)</source>
        <translation>Cg = %1 T / (%2 s)</translation>
    </message>
    <message>
        <source>another, as above</source>
        <translation>eine andere, wie oben</translation>
    </message>
    <message>
        <source>Variant of Cg</source>
        <translation>Art von Cg</translation>
    </message>
    <message>
        <source>Share of the tolerance and sigmas as the company asks for</source>
        <translation>Anteil der Toleranz und Sigmas, wie das Unternehmen sie verlangt</translation>
    </message>
    <message>
        <source>Kept offsets</source>
        <translation>Aufbewahrte Offsets</translation>
    </message>
    <message>
        <source>An offset against a better instrument acts on every run of the region from the moment it is switched on, and every run says so. Undo takes the switch back.</source>
        <translation>Ein Offset gegen ein besseres Messmittel wirkt auf jeden Lauf des Korrekturbereichs, sobald er eingeschaltet ist, und jeder Lauf sagt es. Rückgängig nimmt das Schalten zurück.</translation>
    </message>
    <message>
        <source>Version</source>
        <translation>Fassung</translation>
    </message>
    <message>
        <source>X Y Z mm</source>
        <translation>X Y Z mm</translation>
    </message>
    <message>
        <source>From</source>
        <translation>Woher</translation>
    </message>
    <message>
        <source>Offsets kept of correlations, and which one acts</source>
        <translation>Offsets aus Korrelationen und welcher wirkt</translation>
    </message>
    <message>
        <source>Keep the offset found</source>
        <translation>Gefundenen Offset aufbewahren</translation>
    </message>
    <message>
        <source>The correlation&apos;s offset as a new version; it does not act yet</source>
        <translation>Der Offset der Korrelation als neue Fassung; er wirkt noch nicht</translation>
    </message>
    <message>
        <source>Kept as version %1; it does not act yet</source>
        <translation>Als Fassung %1 aufbewahrt; er wirkt noch nicht</translation>
    </message>
    <message>
        <source>Let it act</source>
        <translation>Wirken lassen</translation>
    </message>
    <message>
        <source>This version acts on every run from here on</source>
        <translation>Diese Fassung wirkt von nun an auf jeden Lauf</translation>
    </message>
    <message>
        <source>None acts</source>
        <translation>Keiner wirkt</translation>
    </message>
    <message>
        <source>No offset acts from here on</source>
        <translation>Von nun an wirkt kein Offset</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Bericht</translation>
    </message>
    <message>
        <source>English</source>
        <translation>Englisch</translation>
    </message>
    <message>
        <source>German</source>
        <translation>Deutsch</translation>
    </message>
    <message>
        <source>Language</source>
        <translation>Sprache</translation>
    </message>
    <message>
        <source>Of the report</source>
        <translation>Des Berichts</translation>
    </message>
    <message>
        <source>Report...</source>
        <translation>Bericht ...</translation>
    </message>
    <message>
        <source>PDF or HTML, with lines to sign</source>
        <translation>PDF oder HTML, mit Zeilen zum Unterschreiben</translation>
    </message>
    <message>
        <source>The artefact&apos;s certificate and points</source>
        <translation>Schein und Punkte des Normals</translation>
    </message>
    <message>
        <source>Parts measured by the other instrument</source>
        <translation>Teile, vom anderen Messmittel gemessen</translation>
    </message>
    <message>
        <source>JSON (*.json)</source>
        <translation>JSON (*.json)</translation>
    </message>
    <message>
        <source>CSV (*.csv)</source>
        <translation>CSV (*.csv)</translation>
    </message>
    <message>
        <source>Acceptance report</source>
        <translation>Abnahmebericht</translation>
    </message>
    <message>
        <source>PDF (*.pdf);;HTML (*.html)</source>
        <translation>PDF (*.pdf);;HTML (*.html)</translation>
    </message>
    <message>
        <source>The report is in %1</source>
        <translation>Der Bericht steht in %1</translation>
    </message>
    <message>
        <source>The values are in %1</source>
        <translation>Die Werte stehen in %1</translation>
    </message>
    <message>
        <source>Tolerance T %1 mm, %2 to %3 mm</source>
        <translation>Toleranz T %1 mm, %2 bis %3 mm</translation>
    </message>
    <message>
        <source>The tolerance is not stated yet</source>
        <translation>Die Toleranz ist noch nicht angegeben</translation>
    </message>
    <message>
        <source>%1, simulated</source>
        <translation>%1, simuliert</translation>
    </message>
    <message>
        <source>looking at the stored runs</source>
        <translation>die gespeicherten Läufe werden angesehen</translation>
    </message>
    <message>
        <source>Next: state the tolerance</source>
        <translation>Weiter: die Toleranz angeben</translation>
    </message>
    <message>
        <source>Next: %1, %2</source>
        <translation>Weiter: %1, %2</translation>
    </message>
    <message>
        <source>Next: write the report...</source>
        <translation>Weiter: den Bericht schreiben ...</translation>
    </message>
    <message>
        <source>done</source>
        <translation>fertig</translation>
    </message>
    <message>
        <source>not begun</source>
        <translation>nicht begonnen</translation>
    </message>
    <message>
        <source>%1 of %2 runs</source>
        <translation>%1 von %2 Läufen</translation>
    </message>
    <message>
        <source>begun</source>
        <translation>begonnen</translation>
    </message>
    <message>
        <source>measure</source>
        <translation>messen</translation>
    </message>
    <message>
        <source>import JSON...</source>
        <translation>JSON einlesen ...</translation>
    </message>
    <message>
        <source>import CSV...</source>
        <translation>CSV einlesen ...</translation>
    </message>
    <message>
        <source>go to Prove</source>
        <translation>zum Nachweis</translation>
    </message>
    <message>
        <source>go on with run %1 of %2</source>
        <translation>weiter mit Lauf %1 von %2</translation>
    </message>
    <message>
        <source>measure %1 runs</source>
        <translation>%1 Läufe messen</translation>
    </message>
    <message>
        <source>Forecast and measurement</source>
        <translation>Vorhersage und Messung</translation>
    </message>
    <message>
        <source>&lt;p&gt;&lt;b&gt;Forecast&lt;/b&gt;: Cg %1, %GRR %2&lt;/p&gt;</source>
        <translation>&lt;p&gt;&lt;b&gt;Vorhersage&lt;/b&gt;: Cg %1, %GRR %2&lt;/p&gt;</translation>
    </message>
    <message>
        <source>acts</source>
        <translation>wirkt</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>mean</source>
        <translation>Mittel</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1: %2</translation>
    </message>
    <message>
        <source>Values...</source>
        <translation>Werte ...</translation>
    </message>
    <message>
        <source>The values as Q-DAS ASCII (.dfq) or as an Excel workbook (.xlsx)</source>
        <translation>Die Werte als Q-DAS ASCII (.dfq) oder als Excel-Mappe (.xlsx)</translation>
    </message>
    <message>
        <source>Values</source>
        <translation>Werte</translation>
    </message>
    <message>
        <source>Q-DAS (*.dfq);;Excel (*.xlsx)</source>
        <translation>Q-DAS (*.dfq);;Excel (*.xlsx)</translation>
    </message>
</context>
<context>
    <name>seamwright::AcceptanceDesk</name>
    <message>
        <source>Take the robot&apos;s repeatability</source>
        <translation>Wiederholgenauigkeit des Roboters übernehmen</translation>
    </message>
    <message>
        <source>Take the trigger&apos;s latency and jitter</source>
        <translation>Latenz und Jitter des Triggers übernehmen</translation>
    </message>
    <message>
        <source>the kept offsets</source>
        <translation>aufbewahrte Offsets</translation>
    </message>
    <message>
        <source>the acting offset</source>
        <translation>wirkender Offset</translation>
    </message>
</context>
<context>
    <name>seamwright::AlignPage</name>
    <message>
        <source>While the robot passes the spot along the contour, the profile should stand still. Then trigger jitter does no harm.</source>
        <translation>Während der Roboter die Messstelle entlang der Kontur durchfährt, soll das Profil stillstehen. Dann schadet Triggerstreuung nicht.</translation>
    </message>
    <message>
        <source>Step of the pass</source>
        <translation>Schrittweite der Durchfahrt</translation>
    </message>
    <message>
        <source>Travel between two profiles</source>
        <translation>Weg zwischen zwei Profilen</translation>
    </message>
    <message>
        <source>Tolerance</source>
        <translation>Toleranz</translation>
    </message>
    <message>
        <source>Error that the trigger jitter may cause at most</source>
        <translation>Fehler, den die Triggerstreuung höchstens bewirken darf</translation>
    </message>
    <message>
        <source>Run entry -&gt; exit</source>
        <translation>Fahren: Einfahrt -&gt; Ausfahrt</translation>
    </message>
    <message>
        <source>The robot goes along the contour and stops at every step; nothing is written</source>
        <translation>Der Roboter fährt entlang der Kontur und hält an jedem Schritt; nichts wird geschrieben</translation>
    </message>
    <message>
        <source>Accept</source>
        <translation>Annehmen</translation>
    </message>
    <message>
        <source>Keeps jitter window and the contour&apos;s curve with the spot</source>
        <translation>Behält Streufenster und Verlauf der Kontur bei der Messstelle</translation>
    </message>
    <message>
        <source>Adopt turned pose</source>
        <translation>Gedrehte Pose übernehmen</translation>
    </message>
    <message>
        <source>Turns the taught pose about the reference point by the rotation that cures it; teach again then</source>
        <translation>Dreht die eingelernte Pose um den Referenzpunkt um den heilenden Winkel; danach neu einlernen</translation>
    </message>
    <message>
        <source>edge recorded earlier</source>
        <translation>Kante früher aufgenommen</translation>
    </message>
    <message>
        <source>no pass recorded</source>
        <translation>keine Durchfahrt aufgezeichnet</translation>
    </message>
    <message>
        <source>Entry %1 mm, exit %2 mm, jitter ±%3 mm</source>
        <translation>Einfahrt %1&#xa0;mm, Ausfahrt %2&#xa0;mm, Streuung ±%3&#xa0;mm</translation>
    </message>
    <message>
        <source>Choose a spot.</source>
        <translation>Eine Messstelle wählen.</translation>
    </message>
    <message>
        <source>FROZEN</source>
        <translation>STEHT STILL</translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation>DRIFTET</translation>
    </message>
    <message>
        <source>SHAPE CHANGES</source>
        <translation>FORM ÄNDERT SICH</translation>
    </message>
    <message>
        <source>NOT ENOUGH PROFILES</source>
        <translation>ZU WENIGE PROFILE</translation>
    </message>
    <message>
        <source>UNDETERMINED</source>
        <translation>UNBESTIMMT</translation>
    </message>
    <message>
        <source>yaw %1 deg, pitch %2 deg, radius %3, expected error %4 mm</source>
        <translation>Gieren %1 Grad, Nicken %2 Grad, Radius %3, erwarteter Fehler %4 mm</translation>
    </message>
    <message>
        <source>straight</source>
        <translation>gerade</translation>
    </message>
    <message>
        <source>The feature was found in too few profiles to learn the contour&apos;s curve.</source>
        <translation>Das Merkmal wurde in zu wenigen Profilen gefunden, um den Verlauf der Kontur zu lernen.</translation>
    </message>
    <message>
        <source>To cure: %1</source>
        <translation>Abhilfe: %1</translation>
    </message>
    <message>
        <source>alignment</source>
        <translation>Ausrichtung</translation>
    </message>
    <message>
        <source>pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <source>frozen at a widened tolerance</source>
        <translation>steht still bei erweiterter Toleranz</translation>
    </message>
    <message>
        <source>Tolerance %1 mm, required are %2 mm</source>
        <translation>Toleranz %1 mm, gefordert sind %2 mm</translation>
    </message>
</context>
<context>
    <name>seamwright::AlignView</name>
    <message>
        <source>Shift and turn against travel</source>
        <translation>Versatz und Drehung über dem Weg</translation>
    </message>
    <message>
        <source>dx (mm)</source>
        <translation>dx (mm)</translation>
    </message>
    <message>
        <source>dz (mm)</source>
        <translation>dz (mm)</translation>
    </message>
    <message>
        <source>turn (°)</source>
        <translation>Drehung (°)</translation>
    </message>
    <message>
        <source>travel (mm), trigger at 0</source>
        <translation>mm ab Trigger</translation>
    </message>
    <message>
        <source>Run the robot from entry to exit: dx, dz and the turn of every profile against the one at the trigger appear here. A contour that stands still is flat.</source>
        <translation>Den Roboter von der Einfahrt zur Ausfahrt fahren: dx, dz und Drehung jedes Profils gegen das am Trigger erscheinen hier. Eine stillstehende Kontur ist flach.</translation>
    </message>
    <message>
        <source>Profiles over travel</source>
        <translation>Profile über dem Weg</translation>
    </message>
    <message>
        <source>x (mm)</source>
        <translation>x (mm)</translation>
    </message>
    <message>
        <source>z (mm)</source>
        <translation>z (mm)</translation>
    </message>
    <message>
        <source>travel (mm)</source>
        <translation>Weg (mm)</translation>
    </message>
    <message>
        <source>Frozen contour</source>
        <translation>Stehende Kontur</translation>
    </message>
    <message>
        <source>Does the contour stand still while the robot passes the spot?</source>
        <translation>Steht die Kontur still, während der Roboter die Messstelle durchfährt?</translation>
    </message>
    <message>
        <source>Drag either blue line, or press Left and Right: how far the trigger may miss</source>
        <translation>Eine blaue Linie ziehen oder Links und Rechts drücken: wie weit der Trigger danebenliegen darf</translation>
    </message>
    <message>
        <source>Image</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>x to the right, travel upwards, height as colour: upright bands stand still</source>
        <translation>x nach rechts, Weg nach oben, Höhe als Farbe: senkrechte Bänder stehen still</translation>
    </message>
    <message>
        <source>Overlay</source>
        <translation>Überlagert</translation>
    </message>
    <message>
        <source>All profiles over each other; the live one thin over the frozen one</source>
        <translation>Alle Profile übereinander; das laufende dünn über dem stehenden</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>Reason and cure</source>
        <translation>Grund und Abhilfe</translation>
    </message>
    <message>
        <source>Yaw</source>
        <translation>Gieren</translation>
    </message>
    <message>
        <source>atan(dx/dy), sensor frame, ± sigma</source>
        <translation>atan(dx/dy), Sensorkoordinaten, ± Sigma</translation>
    </message>
    <message>
        <source>Pitch</source>
        <translation>Nicken</translation>
    </message>
    <message>
        <source>atan(dz/dy), sensor frame, ± sigma</source>
        <translation>atan(dz/dy), Sensorkoordinaten, ± Sigma</translation>
    </message>
    <message>
        <source>Twist</source>
        <translation>Verdrehung</translation>
    </message>
    <message>
        <source>Turn of the profile over the jitter&apos;s half width</source>
        <translation>Drehung des Profils über die halbe Streubreite</translation>
    </message>
    <message>
        <source>Local radius</source>
        <translation>Örtlicher Radius</translation>
    </message>
    <message>
        <source>Of the contour&apos;s own curvature along the travel</source>
        <translation>Der eigenen Krümmung der Kontur entlang des Wegs</translation>
    </message>
    <message>
        <source>Error from jitter</source>
        <translation>Fehler durch Streuung</translation>
    </message>
    <message>
        <source>Largest shift within the jitter window</source>
        <translation>Größter Versatz im Streufenster</translation>
    </message>
    <message>
        <source>Tolerance</source>
        <translation>Toleranz</translation>
    </message>
    <message>
        <source>What the jitter may cause at most, and the window it was judged over</source>
        <translation>Was die Streuung höchstens bewirken darf, und das beurteilte Fenster</translation>
    </message>
    <message>
        <source>Shape change</source>
        <translation>Formänderung</translation>
    </message>
    <message>
        <source>What remains after the profiles are laid over each other</source>
        <translation>Was bleibt, nachdem die Profile übereinandergelegt sind</translation>
    </message>
    <message>
        <source>NOT RECORDED</source>
        <translation>NICHT AUFGEZEICHNET</translation>
    </message>
    <message>
        <source>Run the robot slowly from entry over the trigger to the exit.</source>
        <translation>Den Roboter langsam von der Einfahrt über den Trigger zur Ausfahrt fahren.</translation>
    </message>
    <message>
        <source>RECORDING</source>
        <translation>ZEICHNET AUF</translation>
    </message>
    <message numerus="yes">
        <source>%n profiles so far</source>
        <translation>
            <numerusform>bisher %n Profil</numerusform>
            <numerusform>bisher %n Profile</numerusform>
        </translation>
    </message>
    <message>
        <source>not seen</source>
        <translation>nicht gesehen</translation>
    </message>
    <message>
        <source>straight</source>
        <translation>gerade</translation>
    </message>
    <message>
        <source>%1 m</source>
        <translation>%1 m</translation>
    </message>
    <message>
        <source>%1 mm</source>
        <translation>%1 mm</translation>
    </message>
    <message>
        <source>%1 mm / ±%2 mm</source>
        <translation>%1 mm / ±%2 mm</translation>
    </message>
    <message>
        <source>FROZEN</source>
        <translation>STEHT STILL</translation>
    </message>
    <message>
        <source>The contour stands still within the tolerance.</source>
        <translation>Die Kontur steht innerhalb der Toleranz still.</translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation>DRIFTET</translation>
    </message>
    <message>
        <source>The jitter causes more than the tolerance.</source>
        <translation>Die Streuung bewirkt mehr als die Toleranz.</translation>
    </message>
    <message>
        <source>SHAPE CHANGES</source>
        <translation>FORM ÄNDERT SICH</translation>
    </message>
    <message>
        <source>The profile changes its shape within the jitter: move the spot along the contour.</source>
        <translation>Das Profil ändert innerhalb der Streuung seine Form: die Messstelle entlang der Kontur verlegen.</translation>
    </message>
    <message>
        <source>TOO FEW PROFILES</source>
        <translation>ZU WENIGE PROFILE</translation>
    </message>
    <message>
        <source>UNDETERMINED</source>
        <translation>UNBESTIMMT</translation>
    </message>
    <message>
        <source>What is seen does not tell whether the contour stands still.</source>
        <translation>Was zu sehen ist, sagt nicht, ob die Kontur stillsteht.</translation>
    </message>
    <message>
        <source>Fewer than 5 usable profiles, or less than 1 mm of travel: record the pass again, slower.</source>
        <translation>Weniger als 5 brauchbare Profile oder weniger als 1 mm Weg: die Durchfahrt langsamer wiederholen.</translation>
    </message>
    <message>
        <source>The profile is a straight line: only the drift across it is seen.</source>
        <translation>Das Profil ist eine Gerade: nur die Drift quer dazu ist sichtbar.</translation>
    </message>
    <message>
        <source>Rotation that cures the drift</source>
        <translation>Drehung, die die Drift behebt</translation>
    </message>
    <message>
        <source>Turn the sensor this way, seen along the axis towards the eye</source>
        <translation>Den Sensor in dieser Richtung drehen, entlang der Achse zum Auge gesehen</translation>
    </message>
    <message>
        <source>about %1: %2%3°</source>
        <translation>um %1: %2%3°</translation>
    </message>
    <message>
        <source>about %1: none</source>
        <translation>um %1: keine</translation>
    </message>
    <message>
        <source>Z</source>
        <translation>Z</translation>
    </message>
    <message>
        <source>X</source>
        <translation>X</translation>
    </message>
    <message>
        <source>Every profile of the pass over the travel; the buttons above change the picture</source>
        <translation>Alle Profile der Durchfahrt über dem Weg; die Knöpfe darüber wechseln das Bild</translation>
    </message>
    <message>
        <source>WIDENED</source>
        <translation>ERWEITERT</translation>
    </message>
    <message>
        <source>The contour stands still within a tolerance that is wider than the project requires.</source>
        <translation>Die Kontur steht innerhalb einer Toleranz still, die weiter ist, als das Projekt verlangt.</translation>
    </message>
</context>
<context>
    <name>seamwright::BudgetPanel</name>
    <message>
        <source>Across the bead at spot %1, where it is worst: u = %2 mm (random %3, systematic %4), U = %5 mm (95 %). The shares of the variance:</source>
        <translation>Quer zur Raupe an Messstelle %1, wo es am schlechtesten ist: u = %2 mm (zufällig %3, systematisch %4), U = %5 mm (95 %). Die Anteile an der Varianz:</translation>
    </message>
    <message>
        <source>%1 % of it, u = %2 mm without: %3</source>
        <translation>%1 % davon, u = %2 mm ohne: %3</translation>
    </message>
    <message>
        <source>What to mend, the largest first:</source>
        <translation>Was zu verbessern ist, das Größte zuerst:</translation>
    </message>
    <message>
        <source>Not stated, therefore not in it:</source>
        <translation>Nicht angegeben, deshalb nicht darin:</translation>
    </message>
</context>
<context>
    <name>seamwright::CalibratePage</name>
    <message>
        <source>of unknown age</source>
        <translation>unbekannten Alters</translation>
    </message>
    <message>
        <source>of today</source>
        <translation>von heute</translation>
    </message>
    <message numerus="yes">
        <source>%n day(s) old</source>
        <translation>
            <numerusform>%n Tag alt</numerusform>
            <numerusform>%n Tage alt</numerusform>
        </translation>
    </message>
    <message>
        <source>From pixels to millimetres on the flange. Each sensor uses one calibration; the others stay selectable.</source>
        <translation>Von Pixeln zu Millimetern am Flansch. Jeder Sensor benutzt eine Kalibrierung; die anderen bleiben wählbar.</translation>
    </message>
    <message>
        <source>A new calibration</source>
        <translation>Eine neue Kalibrierung</translation>
    </message>
    <message>
        <source>The project holds no calibration yet.</source>
        <translation>Das Projekt enthält noch keine Kalibrierung.</translation>
    </message>
    <message>
        <source>%1: sensor %2 on robot %3</source>
        <translation>%1: Sensor %2 an Roboter %3</translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation>%1, %2</translation>
    </message>
    <message>
        <source>Method %1. From: %2</source>
        <translation>Verfahren %1. Aus: %2</translation>
    </message>
    <message>
        <source>flange_from_sensor  X %1  Y %2  Z %3 mm</source>
        <translation>flange_from_sensor  X %1  Y %2  Z %3 mm</translation>
    </message>
    <message>
        <source>Made with device %1; connected is %2: pushes are refused.</source>
        <translation>Mit Gerät %1 gemacht; verbunden ist %2: Übertragungen werden abgelehnt.</translation>
    </message>
    <message>
        <source>In use</source>
        <translation>In Benutzung</translation>
    </message>
    <message>
        <source>Use</source>
        <translation>Benutzen</translation>
    </message>
    <message>
        <source>Measure with this calibration from now on</source>
        <translation>Ab jetzt mit dieser Kalibrierung messen</translation>
    </message>
    <message>
        <source>Simulated cell</source>
        <translation>Simulierte Zelle</translation>
    </message>
    <message>
        <source>A simulated sensor knows where it is mounted: enough for learning the other steps.</source>
        <translation>Ein simulierter Sensor weiß, wie er angebaut ist: genug, um die anderen Schritte zu lernen.</translation>
    </message>
    <message>
        <source>Take the simulation&apos;s own</source>
        <translation>Die der Simulation nehmen</translation>
    </message>
    <message>
        <source>Adds the simulated cell&apos;s calibration and uses it</source>
        <translation>Fügt die Kalibrierung der simulierten Zelle hinzu und benutzt sie</translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>The sensor to calibrate</source>
        <translation>Der zu kalibrierende Sensor</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>The robot that carries it, or shows it the target</source>
        <translation>Der Roboter, der ihn trägt oder ihm das Ziel zeigt</translation>
    </message>
    <message>
        <source>Begin</source>
        <translation>Beginnen</translation>
    </message>
    <message>
        <source>Go on</source>
        <translation>Fortsetzen</translation>
    </message>
    <message>
        <source>A sensor that delivers images needs this first: %1.</source>
        <translation>Ein Sensor, der Bilder liefert, braucht zuerst: %1.</translation>
    </message>
    <message>
        <source>Kept as a record: nothing is measured with it.</source>
        <translation>Nur aufbewahrt: gemessen wird damit nicht.</translation>
    </message>
</context>
<context>
    <name>seamwright::CalibrationDesk</name>
    <message>
        <source>State the robot&apos;s repeatability</source>
        <translation>Wiederholgenauigkeit des Roboters angeben</translation>
    </message>
    <message>
        <source>Begin anew</source>
        <translation>Neu beginnen</translation>
    </message>
    <message>
        <source>A circle, but not yet twice at the same place: hold the sensor still.</source>
        <translation>Ein Kreis, aber noch nicht zweimal an derselben Stelle: den Sensor stillhalten.</translation>
    </message>
    <message>
        <source>Trying the conventions of poses</source>
        <translation>Konventionen der Posen werden versucht</translation>
    </message>
    <message>
        <source>Read the poses in the convention found</source>
        <translation>Posen in der gefundenen Konvention lesen</translation>
    </message>
    <message>
        <source>Leave out %1</source>
        <translation>%1 weglassen</translation>
    </message>
    <message>
        <source>Take in %1</source>
        <translation>%1 aufnehmen</translation>
    </message>
    <message>
        <source>Keep %1 for verification</source>
        <translation>%1 zur Prüfung zurückhalten</translation>
    </message>
    <message>
        <source>Solve with %1</source>
        <translation>Mit %1 lösen</translation>
    </message>
    <message>
        <source>Remove capture %1</source>
        <translation>Aufnahme %1 entfernen</translation>
    </message>
    <message>
        <source>Change %1</source>
        <translation>%1 ändern</translation>
    </message>
    <message>
        <source>Capturing</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Capture</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Reading</source>
        <translation>Lesen</translation>
    </message>
    <message>
        <source>Load %1</source>
        <translation>%1 laden</translation>
    </message>
    <message>
        <source>Solving</source>
        <translation>Lösen</translation>
    </message>
    <message>
        <source>Mounting from the drawing</source>
        <translation>Einbaulage aus der Zeichnung</translation>
    </message>
</context>
<context>
    <name>seamwright::CameraView</name>
    <message>
        <source>No camera image yet.
This sensor sends finished profiles, or its raw image is switched off.</source>
        <translation>Noch kein Kamerabild.
Dieser Sensor sendet fertige Profile, oder sein Rohbild ist ausgeschaltet.</translation>
    </message>
    <message>
        <source>saturated %1 px (%2 %)</source>
        <translation>übersteuert %1 px (%2 %)</translation>
    </message>
    <message>
        <source>not saturated, max %1</source>
        <translation>nicht übersteuert, max. %1</translation>
    </message>
    <message>
        <source>Camera image</source>
        <translation>Kamerabild</translation>
    </message>
    <message>
        <source>The sensor&apos;s raw image with the peaks found. Drag moves, wheel zooms, F fits.</source>
        <translation>Das Rohbild des Sensors mit den gefundenen Spitzen. Ziehen verschiebt, Rad zoomt, F passt ein.</translation>
    </message>
    <message>
        <source>Camera image, pixels</source>
        <translation>Kamerabild, Pixel</translation>
    </message>
    <message>
        <source>Camera state</source>
        <translation>Zustand der Kamera</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>Show the whole image (F)</source>
        <translation>Das ganze Bild zeigen (F)</translation>
    </message>
    <message>
        <source>Region</source>
        <translation>Ausschnitt</translation>
    </message>
    <message>
        <source>Drag the region of interest</source>
        <translation>Den Bildausschnitt ziehen</translation>
    </message>
    <message>
        <source>Peaks</source>
        <translation>Spitzen</translation>
    </message>
    <message>
        <source>Peaks: strongest blue, others purple</source>
        <translation>Spitzen: stärkste blau, andere violett</translation>
    </message>
    <message>
        <source>Histogram</source>
        <translation>Histogramm</translation>
    </message>
    <message>
        <source>Grey values, logarithmic, and saturated pixels</source>
        <translation>Grauwerte, logarithmisch, und übersteuerte Pixel</translation>
    </message>
</context>
<context>
    <name>seamwright::CellPage</name>
    <message>
        <source>Reading %1 ...</source>
        <translation>%1 wird gelesen ...</translation>
    </message>
    <message>
        <source>Which sensors and robots there are, and which part they look at. Connect them here.</source>
        <translation>Welche Sensoren und Roboter es gibt und welches Teil sie sehen. Hier werden sie verbunden.</translation>
    </message>
    <message>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <source>Open all sensors and robots of the project</source>
        <translation>Alle Sensoren und Roboter des Projekts öffnen</translation>
    </message>
    <message>
        <source>Disconnect</source>
        <translation>Trennen</translation>
    </message>
    <message>
        <source>Let go of all sensors and robots</source>
        <translation>Alle Sensoren und Roboter freigeben</translation>
    </message>
    <message>
        <source>Sensors and robots</source>
        <translation>Sensoren und Roboter</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>Driver</source>
        <translation>Treiber</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>Sensors and robots of the project</source>
        <translation>Sensoren und Roboter des Projekts</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Give the device another name</source>
        <translation>Dem Gerät einen anderen Namen geben</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Take the device out of the project</source>
        <translation>Das Gerät aus dem Projekt nehmen</translation>
    </message>
    <message>
        <source>Add sensor</source>
        <translation>Sensor hinzufügen</translation>
    </message>
    <message>
        <source>A further sensor</source>
        <translation>Ein weiterer Sensor</translation>
    </message>
    <message>
        <source>Add robot</source>
        <translation>Roboter hinzufügen</translation>
    </message>
    <message>
        <source>A further robot</source>
        <translation>Ein weiterer Roboter</translation>
    </message>
    <message>
        <source>How the device is spoken to</source>
        <translation>Wie mit dem Gerät gesprochen wird</translation>
    </message>
    <message>
        <source>any but stopped and fault</source>
        <translation>außer gestoppt und Störung</translation>
    </message>
    <message>
        <source>Push only in mode</source>
        <translation>Nur übertragen in Betriebsart</translation>
    </message>
    <message>
        <source>Pushes are refused while the robot is in another mode</source>
        <translation>Übertragungen werden abgelehnt, solange der Roboter in einer anderen Betriebsart ist</translation>
    </message>
    <message>
        <source>Settings (JSON)</source>
        <translation>Einstellungen (JSON)</translation>
    </message>
    <message>
        <source>refused: this is no JSON</source>
        <translation>abgelehnt: das ist kein JSON</translation>
    </message>
    <message>
        <source>Apply</source>
        <translation>Übernehmen</translation>
    </message>
    <message>
        <source>Take driver and settings over; connect again afterwards</source>
        <translation>Treiber und Einstellungen übernehmen; danach neu verbinden</translation>
    </message>
    <message>
        <source>Part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>millimetre (checked)</source>
        <translation>Millimeter (geprüft)</translation>
    </message>
    <message>
        <source>millimetre</source>
        <translation>Millimeter</translation>
    </message>
    <message>
        <source>metre</source>
        <translation>Meter</translation>
    </message>
    <message>
        <source>Unit of the file</source>
        <translation>Einheit der Datei</translation>
    </message>
    <message>
        <source>STL, PLY and OBJ do not say their unit</source>
        <translation>STL, PLY und OBJ nennen ihre Einheit nicht</translation>
    </message>
    <message>
        <source>Import part...</source>
        <translation>Teil einlesen...</translation>
    </message>
    <message>
        <source>Mesh of the part in the work object frame: STL, PLY or OBJ</source>
        <translation>Netz des Teils im Werkobjekt-Koordinatensystem: STL, PLY oder OBJ</translation>
    </message>
    <message>
        <source>Work object in the robot&apos;s base</source>
        <translation>Werkobjekt in der Roboterbasis</translation>
    </message>
    <message>
        <source>base_from_workobject: where the part as taught stands</source>
        <translation>base_from_workobject: wo das eingelernte Teil steht</translation>
    </message>
    <message>
        <source>Change the work object&apos;s frame</source>
        <translation>Koordinatensystem des Werkobjekts ändern</translation>
    </message>
    <message>
        <source>Simulated part</source>
        <translation>Simuliertes Teil</translation>
    </message>
    <message>
        <source>Puts the next part into the simulated fixture: up to 10 mm and 0.6 degrees off, a little bent. Or the taught one again.</source>
        <translation>Legt das nächste Teil in die simulierte Vorrichtung: bis 10 mm und 0,6 Grad versetzt, etwas verbogen. Oder wieder das eingelernte.</translation>
    </message>
    <message>
        <source>Displace</source>
        <translation>Versetzen</translation>
    </message>
    <message>
        <source>The next simulated part, displaced</source>
        <translation>Das nächste simulierte Teil, versetzt</translation>
    </message>
    <message>
        <source>As taught</source>
        <translation>Wie eingelernt</translation>
    </message>
    <message>
        <source>The simulated part where it was taught</source>
        <translation>Das simulierte Teil, wo es eingelernt wurde</translation>
    </message>
    <message>
        <source>not connected</source>
        <translation>nicht verbunden</translation>
    </message>
    <message>
        <source>ok, %1 frames</source>
        <translation>ok, %1 Bilder</translation>
    </message>
    <message>
        <source>no frame: %1</source>
        <translation>kein Bild: %1</translation>
    </message>
    <message>
        <source>sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>ok, %1</source>
        <translation>ok, %1</translation>
    </message>
    <message>
        <source>silent: %1</source>
        <translation>stumm: %1</translation>
    </message>
    <message>
        <source>robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>No mesh. Everything works without one; the 3D view is empty then.</source>
        <translation>Kein Netz. Alles geht auch ohne; die 3D-Ansicht ist dann leer.</translation>
    </message>
    <message>
        <source>%1, from %2</source>
        <translation>%1, aus %2</translation>
    </message>
    <message>
        <source>never connected</source>
        <translation>nie verbunden</translation>
    </message>
    <message>
        <source>answers as %1, serial %2</source>
        <translation>antwortet als %1, Seriennummer %2</translation>
    </message>
    <message>
        <source>Exposure and trigger of sensor %1</source>
        <translation>Belichtung und Trigger von Sensor %1</translation>
    </message>
    <message>
        <source>settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Import part</source>
        <translation>Teil einlesen</translation>
    </message>
    <message>
        <source>Meshes (*.stl *.ply *.obj)</source>
        <translation>Netze (*.stl *.ply *.obj)</translation>
    </message>
    <message>
        <source>Requirements</source>
        <translation>Forderungen</translation>
    </message>
    <message>
        <source>What has to be reached before the cell is handed over.</source>
        <translation>Was erreicht sein muss, bevor die Zelle übergeben wird.</translation>
    </message>
    <message>
        <source>3 sigma, at most</source>
        <translation>3 Sigma, höchstens</translation>
    </message>
    <message>
        <source>Age of calibrations</source>
        <translation>Alter der Kalibrierungen</translation>
    </message>
    <message>
        <source>Zero-shift runs</source>
        <translation>Nullverschiebungsläufe</translation>
    </message>
    <message>
        <source>Known translation</source>
        <translation>Bekannte Verschiebung</translation>
    </message>
    <message>
        <source>Known rotation</source>
        <translation>Bekannte Drehung</translation>
    </message>
    <message>
        <source>Settings as text</source>
        <translation>Einstellungen als Text</translation>
    </message>
    <message>
        <source>The settings as the project file holds them (JSON), to copy and to paste</source>
        <translation>Die Einstellungen, wie sie in der Projektdatei stehen (JSON), zum Kopieren und Einfügen</translation>
    </message>
    <message>
        <source>refused: see the marked field</source>
        <translation>abgelehnt: siehe das markierte Feld</translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation>abgelehnt: %1</translation>
    </message>
    <message>
        <source>Search cameras</source>
        <translation>Kameras suchen</translation>
    </message>
    <message>
        <source>Asks all networks of this computer for cameras; one of them is taken by a click</source>
        <translation>Fragt alle Netze dieses Rechners nach Kameras; eine davon wird mit einem Klick übernommen</translation>
    </message>
    <message>
        <source>%1 %2, serial %3, at %4</source>
        <translation>%1 %2, Seriennummer %3, unter %4</translation>
    </message>
    <message>
        <source>No camera has answered: check power, cable and the network&apos;s address</source>
        <translation>Keine Kamera hat geantwortet: Strom, Kabel und die Adresse des Netzes prüfen</translation>
    </message>
    <message>
        <source>camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>%1: the settings are not taken over, %2.</source>
        <translation>%1: Die Einstellungen werden nicht übernommen, %2.</translation>
    </message>
    <message>
        <source>Mend them, or press Esc in the form: the old ones come back.</source>
        <translation>Berichtigen, oder im Formular Esc drücken: dann stehen die alten wieder da.</translation>
    </message>
</context>
<context>
    <name>seamwright::CommandPalette</name>
    <message>
        <source>All actions</source>
        <translation>Alle Aktionen</translation>
    </message>
    <message>
        <source>Type a few letters</source>
        <translation>Ein paar Buchstaben tippen</translation>
    </message>
    <message>
        <source>Search actions</source>
        <translation>Aktionen suchen</translation>
    </message>
    <message>
        <source>Letters in order; Enter runs the marked action</source>
        <translation>Buchstaben in Reihenfolge; Enter führt die markierte Aktion aus</translation>
    </message>
    <message>
        <source>Actions found</source>
        <translation>Gefundene Aktionen</translation>
    </message>
    <message>
        <source>Enter or double click runs an action</source>
        <translation>Enter oder Doppelklick führt eine Aktion aus</translation>
    </message>
</context>
<context>
    <name>seamwright::CoverageView</name>
    <message>
        <source>Coverage of field and orientations</source>
        <translation>Abdeckung von Messfeld und Orientierungen</translation>
    </message>
    <message>
        <source>Left: where in the field the target was seen. Right: tilt of the sensor against the first capture, 10 degrees a ring; the tick is the turn about the line of sight.</source>
        <translation>Links: wo im Messfeld das Ziel gesehen wurde. Rechts: Neigung des Sensors gegen die erste Aufnahme, 10 Grad je Ring; der Strich ist die Drehung um die Blickrichtung.</translation>
    </message>
    <message>
        <source>field %1 %</source>
        <translation>Messfeld %1 %</translation>
    </message>
    <message>
        <source>Field: %1 % covered</source>
        <translation>Messfeld: %1 % abgedeckt</translation>
    </message>
    <message>
        <source>Orientations, 10° a ring</source>
        <translation>Orientierungen, 10° je Ring</translation>
    </message>
</context>
<context>
    <name>seamwright::Desk</name>
    <message>
        <source>The unsaved edits of an earlier session cannot be read (%1). They were set aside as %2.</source>
        <translation>Die ungespeicherten Änderungen einer früheren Sitzung sind nicht lesbar (%1). Sie wurden als %2 beiseitegelegt.</translation>
    </message>
    <message>
        <source>The unsaved edits of an earlier session cannot be read (%1). They stand in the way of those of this session, which are not kept against a crash: %2</source>
        <translation>Die ungespeicherten Änderungen einer früheren Sitzung sind nicht lesbar (%1). Sie stehen denen dieser Sitzung im Weg, die nicht gegen einen Absturz gesichert sind: %2</translation>
    </message>
</context>
<context>
    <name>seamwright::EventList</name>
    <message>
        <source>Person</source>
        <translation>Person</translation>
    </message>
    <message>
        <source>Event log</source>
        <translation>Ereignisprotokoll</translation>
    </message>
    <message>
        <source>What happened, newest first</source>
        <translation>Was geschah, Neuestes zuerst</translation>
    </message>
    <message>
        <source>When</source>
        <translation>Wann</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>Subject</source>
        <translation>Betreff</translation>
    </message>
    <message>
        <source>Text</source>
        <translation>Text</translation>
    </message>
    <message>
        <source>note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>refusal</source>
        <translation>Ablehnung</translation>
    </message>
    <message>
        <source>push attempt</source>
        <translation>Übertragungsversuch</translation>
    </message>
    <message>
        <source>push</source>
        <translation>Übertragung</translation>
    </message>
    <message>
        <source>ALARM</source>
        <translation>ALARM</translation>
    </message>
    <message>
        <source>device</source>
        <translation>Gerät</translation>
    </message>
</context>
<context>
    <name>seamwright::ExchangeDialog</name>
    <message>
        <source>After an exchange of sensor or robot</source>
        <translation>Nach Austausch von Sensor oder Roboter</translation>
    </message>
    <message>
        <source>Only the calibration was repeated. Every spot&apos;s flange pose is led so that the sensor stands at the part where it stood before; references, features and regions stay as taught.</source>
        <translation>Nur die Kalibrierung wurde wiederholt. Die Flanschlage jeder Messstelle wird so nachgeführt, dass der Sensor am Teil steht wie vorher; Referenzen, Merkmale und Korrekturbereiche bleiben wie eingelernt.</translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>Whose spots are led along</source>
        <translation>Dessen Messstellen nachgeführt werden</translation>
    </message>
    <message>
        <source>New calibration</source>
        <translation>Neue Kalibrierung</translation>
    </message>
    <message>
        <source>Made after the exchange; it comes into use</source>
        <translation>Nach dem Austausch gemacht; sie wird ab jetzt benutzt</translation>
    </message>
    <message>
        <source>The robot was exchanged or moved; the part stands in its base at:</source>
        <translation>Der Roboter wurde getauscht oder versetzt; das Teil steht in seiner Basis bei:</translation>
    </message>
    <message>
        <source>Give the work object as measured with the new robot</source>
        <translation>Das Werkobjekt, mit dem neuen Roboter gemessen</translation>
    </message>
    <message>
        <source>Work object in the new robot&apos;s base</source>
        <translation>Werkobjekt in der Basis des neuen Roboters</translation>
    </message>
    <message>
        <source>base_from_workobject, measured with the new robot</source>
        <translation>base_from_workobject, mit dem neuen Roboter gemessen</translation>
    </message>
    <message>
        <source>Lead the spots along</source>
        <translation>Messstellen nachführen</translation>
    </message>
    <message>
        <source>One step; can be undone</source>
        <translation>Ein Schritt; kann rückgängig gemacht werden</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Nothing is changed</source>
        <translation>Nichts wird geändert</translation>
    </message>
    <message>
        <source>%1 spots; a flange pose moves by %2 mm and %3 deg at most</source>
        <translation>%1 Messstellen; eine Flanschlage ändert sich um höchstens %2 mm und %3 Grad</translation>
    </message>
</context>
<context>
    <name>seamwright::GuidedPage</name>
    <message>
        <source>Puts these captures aside, on disk, and begins with none; undo brings them back</source>
        <translation>Legt diese Aufnahmen auf der Platte beiseite und beginnt mit keiner; Rückgängig bringt sie zurück</translation>
    </message>
    <message>
        <source>The robot&apos;s repeatability, one standard deviation of an arrival in each axis: about a third of the RP of its data sheet. 0: not stated.</source>
        <translation>Die Wiederholgenauigkeit des Roboters, eine Standardabweichung einer Ankunft in jeder Achse: etwa ein Drittel des RP seines Datenblatts. 0: nicht angegeben.</translation>
    </message>
    <message>
        <source>Repeatability of its place</source>
        <translation>Wiederholgenauigkeit, Ort</translation>
    </message>
    <message>
        <source>Repeatability of its turn</source>
        <translation>Wiederholgenauigkeit, Drehung</translation>
    </message>
    <message numerus="yes">
        <source>%n more pose(s)</source>
        <translation>
            <numerusform>noch %n Pose</numerusform>
            <numerusform>noch %n Posen</numerusform>
        </translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1: %2</translation>
    </message>
    <message>
        <source>Every capture is needed to solve with: take or load more.</source>
        <translation>Zum Lösen wird jede Aufnahme gebraucht: mehr aufnehmen oder laden.</translation>
    </message>
    <message>
        <source>Nothing is seen where the second pose should be: the first capture was probably not the target. Remove it, or correct the mounting from the drawing.</source>
        <translation>Wo die zweite Pose sein soll, ist nichts zu sehen: die erste Aufnahme war wohl nicht das Ziel. Sie entfernen, oder die Montage laut Zeichnung berichtigen.</translation>
    </message>
    <message>
        <source>%1. It sees the simulated target until this page is left.</source>
        <translation>%1. Er sieht das simulierte Ziel, bis diese Seite verlassen wird.</translation>
    </message>
    <message>
        <source>Every view has been taken and the solution does not serve yet: state the robot&apos;s repeatability, leave out what stands out, or jog to other places and capture there.</source>
        <translation>Jede Ansicht ist aufgenommen und die Lösung genügt noch nicht: die Wiederholgenauigkeit des Roboters angeben, weglassen, was herausfällt, oder an andere Stellen verfahren und dort aufnehmen.</translation>
    </message>
    <message numerus="yes">
        <source>%n pose(s) agree, but the solution is %1: %2</source>
        <translation>
            <numerusform>%n Pose stimmt überein, aber die Lösung ist %1: %2</numerusform>
            <numerusform>%n Posen stimmen überein, aber die Lösung ist %1: %2</numerusform>
        </translation>
    </message>
    <message>
        <source>Capture %1 of %2</source>
        <translation>Aufnahme %1 von %2</translation>
    </message>
    <message>
        <source>Moves the robot straight to the next pose: look whether the way is free</source>
        <translation>Fährt den Roboter geradewegs zur nächsten Pose: nachsehen, ob der Weg frei ist</translation>
    </message>
    <message>
        <source>Sends the robot straight to one proposed pose after the other and captures there: look whether the ways are free</source>
        <translation>Schickt den Roboter geradewegs von einer vorgeschlagenen Pose zur nächsten und nimmt dort auf: nachsehen, ob die Wege frei sind</translation>
    </message>
    <message>
        <source>Capture all</source>
        <translation>Alle aufnehmen</translation>
    </message>
    <message>
        <source>Stops what runs; captures are kept. A motion under way is done, none follows.</source>
        <translation>Hält an, was läuft; Aufnahmen bleiben. Eine begonnene Fahrt wird beendet, keine folgt.</translation>
    </message>
    <message>
        <source>Which convention?</source>
        <translation>Welche Konvention?</translation>
    </message>
    <message>
        <source>Tries the poses in every convention of angles, units, order and direction; changes nothing</source>
        <translation>Versucht die Posen in jeder Konvention von Winkeln, Einheiten, Reihenfolge und Richtung; ändert nichts</translation>
    </message>
    <message>
        <source>Read them so</source>
        <translation>So lesen</translation>
    </message>
    <message>
        <source>Reads all poses of this session in the convention found; undo takes it back</source>
        <translation>Liest alle Posen dieser Sitzung in der gefundenen Konvention; Rückgängig nimmt es zurück</translation>
    </message>
    <message>
        <source>Residual as given %1 mm, in the best other reading %2 mm</source>
        <translation>Restfehler wie angegeben %1 mm, in der besten anderen Lesart %2 mm</translation>
    </message>
    <message>
        <source>Undo the last change of this calibration</source>
        <translation>Die letzte Änderung dieser Kalibrierung rückgängig machen</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wiederholen</translation>
    </message>
    <message>
        <source>All methods</source>
        <translation>Alle Verfahren</translation>
    </message>
    <message>
        <source>Back to the list; everything captured is kept</source>
        <translation>Zurück zur Liste; alle Aufnahmen bleiben erhalten</translation>
    </message>
    <message>
        <source>What I need</source>
        <translation>Was ich brauche</translation>
    </message>
    <message>
        <source>Shows or hides what this method is for and what it needs</source>
        <translation>Zeigt oder verbirgt, wozu dieses Verfahren dient und was es braucht</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>Fortschritt</translation>
    </message>
    <message>
        <source>How far reading and solving are</source>
        <translation>Wie weit Lesen und Lösen sind</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Capture</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Takes picture and robot pose; the robot must stand still</source>
        <translation>Nimmt Bild und Roboterpose auf; der Roboter muss stillstehen</translation>
    </message>
    <message>
        <source>By itself</source>
        <translation>Von selbst</translation>
    </message>
    <message>
        <source>Captures whenever the robot has stood still for half a second at a new place</source>
        <translation>Nimmt auf, sobald der Roboter an neuer Stelle eine halbe Sekunde stillsteht</translation>
    </message>
    <message>
        <source>Set up the target</source>
        <translation>Ziel aufstellen</translation>
    </message>
    <message>
        <source>Puts this method&apos;s target before the simulated sensor</source>
        <translation>Stellt das Ziel dieses Verfahrens vor den simulierten Sensor</translation>
    </message>
    <message>
        <source>Go there</source>
        <translation>Dorthin fahren</translation>
    </message>
    <message>
        <source>Copy</source>
        <translation>Kopieren</translation>
    </message>
    <message>
        <source>Puts the next pose into the clipboard</source>
        <translation>Legt die nächste Pose in die Zwischenablage</translation>
    </message>
    <message>
        <source>Load from files</source>
        <translation>Aus Dateien laden</translation>
    </message>
    <message>
        <source>Takes captures from files instead of the live sensor</source>
        <translation>Nimmt Aufnahmen aus Dateien statt vom Sensor</translation>
    </message>
    <message>
        <source>Pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>deg</source>
        <translation>Grad</translation>
    </message>
    <message>
        <source>px</source>
        <translation>px</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>Captures with their residual; take the tick away to leave one out and solve again</source>
        <translation>Aufnahmen mit ihrem Restfehler; Haken wegnehmen, um eine wegzulassen und neu zu lösen</translation>
    </message>
    <message>
        <source>Keep for verification</source>
        <translation>Zur Prüfung zurückhalten</translation>
    </message>
    <message>
        <source>The chosen pose judges the solution instead of taking part in it</source>
        <translation>Die gewählte Pose beurteilt die Lösung, statt an ihr teilzunehmen</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Takes the chosen pose off the list</source>
        <translation>Nimmt die gewählte Pose von der Liste</translation>
    </message>
    <message>
        <source>Solution</source>
        <translation>Lösung</translation>
    </message>
    <message>
        <source>Solve</source>
        <translation>Lösen</translation>
    </message>
    <message>
        <source>Solves with the ticked poses</source>
        <translation>Löst mit den angehakten Posen</translation>
    </message>
    <message>
        <source>Parameter</source>
        <translation>Parameter</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>1 sigma</source>
        <translation>1 Sigma</translation>
    </message>
    <message>
        <source>What was found, and how sure it is</source>
        <translation>Was gefunden wurde und wie sicher es ist</translation>
    </message>
    <message>
        <source>Verification</source>
        <translation>Prüfung</translation>
    </message>
    <message>
        <source>Capture for verification</source>
        <translation>Zur Prüfung aufnehmen</translation>
    </message>
    <message>
        <source>A pose that takes no part in the solution judges it</source>
        <translation>Eine Pose, die nicht an der Lösung teilnimmt, beurteilt sie</translation>
    </message>
    <message>
        <source>Use this calibration</source>
        <translation>Diese Kalibrierung benutzen</translation>
    </message>
    <message>
        <source>Measure with it from now on; the one before stays selectable</source>
        <translation>Ab jetzt damit messen; die vorige bleibt wählbar</translation>
    </message>
    <message>
        <source>Keep beside</source>
        <translation>Daneben behalten</translation>
    </message>
    <message>
        <source>Puts it into the project without using it</source>
        <translation>Legt sie ins Projekt, ohne sie zu benutzen</translation>
    </message>
    <message>
        <source>Begin anew</source>
        <translation>Neu beginnen</translation>
    </message>
    <message>
        <source>Data (*.json)</source>
        <translation>Daten (*.json)</translation>
    </message>
    <message>
        <source>Sensor %1 on robot %2</source>
        <translation>Sensor %1 an Roboter %2</translation>
    </message>
    <message>
        <source>Sensor %1</source>
        <translation>Sensor %1</translation>
    </message>
    <message>
        <source>Waiting for the sensor</source>
        <translation>Warten auf den Sensor</translation>
    </message>
    <message>
        <source>Prepare</source>
        <translation>Vorbereiten</translation>
    </message>
    <message>
        <source>Verify</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Use</source>
        <translation>Benutzen</translation>
    </message>
    <message>
        <source>Keep</source>
        <translation>Behalten</translation>
    </message>
    <message>
        <source>Built on calibration %1, in use.</source>
        <translation>Baut auf der benutzten Kalibrierung %1 auf.</translation>
    </message>
    <message>
        <source>sensor %1 with calibration %2</source>
        <translation>Sensor %1 mit Kalibrierung %2</translation>
    </message>
    <message>
        <source>One capture shoots %1.</source>
        <translation>Eine Aufnahme nimmt auf: %1.</translation>
    </message>
    <message>
        <source>Camera and laser plane are not calibrated yet: begin with them.</source>
        <translation>Kamera und Laserebene sind noch nicht kalibriert: mit ihnen beginnen.</translation>
    </message>
    <message>
        <source>left out</source>
        <translation>weggelassen</translation>
    </message>
    <message>
        <source>verification</source>
        <translation>Prüfung</translation>
    </message>
    <message>
        <source>contradicts the others</source>
        <translation>widerspricht den anderen</translation>
    </message>
    <message>
        <source>captured</source>
        <translation>aufgenommen</translation>
    </message>
    <message>
        <source>stands out</source>
        <translation>fällt auf</translation>
    </message>
    <message>
        <source>used</source>
        <translation>benutzt</translation>
    </message>
    <message numerus="yes">
        <source>%n capture(s), at least %1 are needed</source>
        <translation>
            <numerusform>%n Aufnahme, mindestens %1 werden gebraucht</numerusform>
            <numerusform>%n Aufnahmen, mindestens %1 werden gebraucht</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n capture(s), %1 are better</source>
        <translation>
            <numerusform>%n Aufnahme, %1 sind besser</numerusform>
            <numerusform>%n Aufnahmen, %1 sind besser</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n capture(s)</source>
        <translation>
            <numerusform>%n Aufnahme</numerusform>
            <numerusform>%n Aufnahmen</numerusform>
        </translation>
    </message>
    <message>
        <source>Jog the sensor until the target is outlined, then capture. The next poses follow from the first one.</source>
        <translation>Den Sensor verfahren, bis das Ziel umrandet ist, dann aufnehmen. Die nächsten Posen folgen aus der ersten.</translation>
    </message>
    <message>
        <source>No further pose is proposed: every view has been taken.</source>
        <translation>Es wird keine weitere Pose vorgeschlagen: jede Ansicht ist aufgenommen.</translation>
    </message>
    <message>
        <source>Next pose of the flange (%1): %2</source>
        <translation>Nächste Pose des Flansches (%1): %2</translation>
    </message>
    <message>
        <source>The robot does not tell its pose.</source>
        <translation>Der Roboter nennt seine Pose nicht.</translation>
    </message>
    <message>
        <source>about %1 %2°</source>
        <translation>um %1 %2°</translation>
    </message>
    <message>
        <source>%1 %2 mm</source>
        <translation>%1 %2 mm</translation>
    </message>
    <message>
        <source>The robot stands there.</source>
        <translation>Der Roboter steht dort.</translation>
    </message>
    <message>
        <source>From here, in the sensor&apos;s axes: turn %1; shift %2.</source>
        <translation>Von hier, in den Achsen des Sensors: drehen %1; verschieben %2.</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>not enough captures</source>
        <translation>zu wenige Aufnahmen</translation>
    </message>
    <message>
        <source>not solved yet</source>
        <translation>noch nicht gelöst</translation>
    </message>
    <message>
        <source>Cure: %1</source>
        <translation>Abhilfe: %1</translation>
    </message>
    <message>
        <source>%1 mm of %2 allowed</source>
        <translation>%1 mm von %2 erlaubten</translation>
    </message>
    <message>
        <source>%1° of %2 allowed</source>
        <translation>%1° von %2 erlaubten</translation>
    </message>
    <message>
        <source>%1 px of %2 allowed</source>
        <translation>%1 px von %2 erlaubten</translation>
    </message>
    <message>
        <source>Not verified: %1 stands where %2 was taken, which is solved with, and agrees whatever the answer. Move the robot and take another.</source>
        <translation>Nicht geprüft: %1 steht dort, wo %2 aufgenommen wurde, mit der gelöst wird, und stimmt mit jeder Lösung überein. Den Roboter bewegen und eine weitere aufnehmen.</translation>
    </message>
    <message>
        <source>Not verified: take one more pose that is not solved with, or keep one of the list back.</source>
        <translation>Nicht geprüft: eine weitere Pose aufnehmen, mit der nicht gelöst wird, oder eine der Liste zurückhalten.</translation>
    </message>
    <message numerus="yes">
        <source>confirmed by %n pose(s): %1</source>
        <translation>
            <numerusform>bestätigt durch %n Pose: %1</numerusform>
            <numerusform>bestätigt durch %n Posen: %1</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>not confirmed by %n pose(s): %1</source>
        <translation>
            <numerusform>nicht bestätigt durch %n Pose: %1</numerusform>
            <numerusform>nicht bestätigt durch %n Posen: %1</numerusform>
        </translation>
    </message>
    <message>
        <source>no residual</source>
        <translation>kein Restfehler</translation>
    </message>
    <message>
        <source>Stored in the project as %1.</source>
        <translation>Im Projekt abgelegt als %1.</translation>
    </message>
    <message>
        <source>Use these calibrations</source>
        <translation>Diese Kalibrierungen benutzen</translation>
    </message>
    <message>
        <source>%1 for sensor %2</source>
        <translation>%1 für Sensor %2</translation>
    </message>
    <message>
        <source>Sensor %1: %2</source>
        <translation>Sensor %1: %2</translation>
    </message>
    <message>
        <source>The solution stands for these sensors; stored will be: %1.</source>
        <translation>Die Lösung gilt für diese Sensoren; abgelegt wird: %1.</translation>
    </message>
    <message>
        <source>One shot leaves no pose to verify it with: compare each sensor with what it used before.</source>
        <translation>Eine Aufnahme lässt keine Pose zum Verifizieren übrig: jeden Sensor mit seiner bisherigen Kalibrierung vergleichen.</translation>
    </message>
    <message>
        <source>It has nothing in common with calibration %1, in use.</source>
        <translation>Sie hat mit der benutzten Kalibrierung %1 nichts gemeinsam.</translation>
    </message>
    <message>
        <source>Against calibration %1, in use: the same pixel lies up to %2 mm elsewhere (mean %3 mm); sensor shifted %4 mm, turned %5°.</source>
        <translation>Gegen die benutzte Kalibrierung %1: dasselbe Pixel liegt bis zu %2 mm anderswo (im Mittel %3 mm); Sensor um %4 mm verschoben, um %5° gedreht.</translation>
    </message>
    <message>
        <source>Solve with it</source>
        <translation>Damit lösen</translation>
    </message>
    <message>
        <source>target seen</source>
        <translation>Ziel gesehen</translation>
    </message>
    <message>
        <source>Load images</source>
        <translation>Bilder laden</translation>
    </message>
    <message>
        <source>Takes captures from a folder of images with their pose files</source>
        <translation>Nimmt Aufnahmen aus einem Ordner von Bildern mit ihren Posendateien</translation>
    </message>
    <message>
        <source>The board is looked for with the laser off, at the capture.</source>
        <translation>Die Tafel wird bei ausgeschaltetem Laser gesucht, beim Aufnehmen.</translation>
    </message>
    <message>
        <source>Mounting from the drawing (flange_from_sensor)</source>
        <translation>Einbaulage aus der Zeichnung (flange_from_sensor)</translation>
    </message>
    <message>
        <source>Roughly is enough: it leads to the next poses and tells mirrored axes</source>
        <translation>Ungefähr genügt: sie führt zu den nächsten Posen und erkennt gespiegelte Achsen</translation>
    </message>
    <message>
        <source>Bring the tip to the sphere by hand or slowly by jogging, then capture. Turn the flange between touches.</source>
        <translation>Die Spitze von Hand oder langsam verfahrend an die Kugel bringen, dann aufnehmen. Den Flansch zwischen den Berührungen drehen.</translation>
    </message>
    <message>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <source>Open all sensors and robots of the project</source>
        <translation>Alle Sensoren und Roboter des Projekts öffnen</translation>
    </message>
    <message>
        <source>Sensor %1 is not in the project any more, by this name. Undo that in the project (Ctrl+Z), or go back to all methods.</source>
        <translation>Sensor %1 ist unter diesem Namen nicht mehr im Projekt. Das im Projekt rückgängig machen (Strg+Z) oder zurück zu allen Verfahren gehen.</translation>
    </message>
    <message>
        <source>This method needs a robot, and the project has none: add one on the step Cell.</source>
        <translation>Dieses Verfahren braucht einen Roboter, und das Projekt hat keinen: im Schritt Zelle einen hinzufügen.</translation>
    </message>
    <message>
        <source>Robot %1 is not in the project any more, by this name. Undo that in the project (Ctrl+Z), or go back to all methods.</source>
        <translation>Roboter %1 ist unter diesem Namen nicht mehr im Projekt. Das im Projekt rückgängig machen (Strg+Z) oder zurück zu allen Verfahren gehen.</translation>
    </message>
    <message>
        <source>The devices are not connected: connect them to capture, or load from files what was captured.</source>
        <translation>Die Geräte sind nicht verbunden: zum Aufnehmen verbinden, oder Aufnahmen aus Dateien laden.</translation>
    </message>
    <message>
        <source>not connected</source>
        <translation>nicht verbunden</translation>
    </message>
    <message>
        <source>A value is refused: mend it, or press Esc in its field.</source>
        <translation>Ein Wert wurde abgelehnt: berichtigen, oder in seinem Feld Esc drücken.</translation>
    </message>
</context>
<context>
    <name>seamwright::Histogram</name>
    <message>
        <source>fewer than two values</source>
        <translation>weniger als zwei Werte</translation>
    </message>
    <message>
        <source>n %1   mean %2   s %3 %4</source>
        <translation>n %1   Mittel %2   s %3 %4</translation>
    </message>
    <message>
        <source>Cp %1</source>
        <translation>Cp %1</translation>
    </message>
    <message>
        <source>Cpk %1</source>
        <translation>Cpk %1</translation>
    </message>
    <message>
        <source>(few values)</source>
        <translation>(wenige Werte)</translation>
    </message>
    <message>
        <source>Distribution</source>
        <translation>Verteilung</translation>
    </message>
    <message>
        <source>Distribution with limits. Cp and Cpk assume independent values of one stable, normal process.</source>
        <translation>Verteilung mit Grenzen. Cp und Cpk setzen unabhängige Werte eines stabilen, normalverteilten Prozesses voraus.</translation>
    </message>
    <message>
        <source>Distribution in numbers</source>
        <translation>Verteilung in Zahlen</translation>
    </message>
    <message>
        <source>Distribution chart</source>
        <translation>Verteilungsdiagramm</translation>
    </message>
</context>
<context>
    <name>seamwright::JogPanel</name>
    <message>
        <source>The robot moves when somebody stands beside it: say so with the tick, then press again.</source>
        <translation>Der Roboter fährt, wenn jemand bei ihm steht: mit dem Haken bestätigen, dann noch einmal drücken.</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>The robot that is moved</source>
        <translation>Der Roboter, der bewegt wird</translation>
    </message>
    <message>
        <source>Somebody stands beside the robot</source>
        <translation>Jemand steht beim Roboter</translation>
    </message>
    <message>
        <source>A real robot moves from here only after this was said; asked again after every connection</source>
        <translation>Ein wirklicher Roboter bewegt sich von hier erst, wenn das bestätigt ist; nach jedem Verbinden wird neu gefragt</translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>Flange</source>
        <translation>Flansch</translation>
    </message>
    <message>
        <source>Robot&apos;s base</source>
        <translation>Roboterbasis</translation>
    </message>
    <message>
        <source>Axes of</source>
        <translation>Achsen von</translation>
    </message>
    <message>
        <source>Along and about whose axes the keys move</source>
        <translation>Längs und um wessen Achsen die Tasten bewegen</translation>
    </message>
    <message>
        <source>One step a press</source>
        <translation>Ein Schritt je Druck</translation>
    </message>
    <message>
        <source>As long as pressed</source>
        <translation>Solange gedrückt</translation>
    </message>
    <message>
        <source>Way</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>What one press of a key does</source>
        <translation>Was ein Druck auf eine Taste tut</translation>
    </message>
    <message>
        <source>%1 mm, %2°</source>
        <translation>%1 mm, %2°</translation>
    </message>
    <message>
        <source>Step</source>
        <translation>Schritt</translation>
    </message>
    <message>
        <source>How far one press moves and turns</source>
        <translation>Wie weit ein Druck bewegt und dreht</translation>
    </message>
    <message>
        <source> mm/s</source>
        <translation> mm/s</translation>
    </message>
    <message>
        <source>Speed</source>
        <translation>Geschwindigkeit</translation>
    </message>
    <message>
        <source>While a key is pressed; turns go at a fifth of it in degrees a second</source>
        <translation>Solange eine Taste gedrückt ist; Drehungen mit einem Fünftel davon in Grad je Sekunde</translation>
    </message>
    <message>
        <source>along X</source>
        <translation>längs X</translation>
    </message>
    <message>
        <source>along Y</source>
        <translation>längs Y</translation>
    </message>
    <message>
        <source>along Z</source>
        <translation>längs Z</translation>
    </message>
    <message>
        <source>about X</source>
        <translation>um X</translation>
    </message>
    <message>
        <source>about Y</source>
        <translation>um Y</translation>
    </message>
    <message>
        <source>about Z</source>
        <translation>um Z</translation>
    </message>
    <message>
        <source>back</source>
        <translation>zurück</translation>
    </message>
    <message>
        <source>ahead</source>
        <translation>vor</translation>
    </message>
    <message>
        <source>The project has no robot yet.</source>
        <translation>Das Projekt hat noch keinen Roboter.</translation>
    </message>
    <message>
        <source>Connect the devices first.</source>
        <translation>Zuerst die Geräte verbinden.</translation>
    </message>
    <message>
        <source>The robot does not answer.</source>
        <translation>Der Roboter antwortet nicht.</translation>
    </message>
    <message>
        <source>This robot is not moved from here: jog it at its own panel.</source>
        <translation>Dieser Roboter wird nicht von hier bewegt: am eigenen Bediengerät verfahren.</translation>
    </message>
    <message>
        <source>Flange: X %1  Y %2  Z %3 mm, A %4  B %5  C %6 degrees</source>
        <translation>Flansch: X %1  Y %2  Z %3 mm, A %4  B %5  C %6 Grad</translation>
    </message>
    <message>
        <source>The robot does not tell where it stands, and is not moved from here before it does: move it once at its own panel.</source>
        <translation>Der Roboter sagt nicht, wo er steht, und wird vorher nicht von hier bewegt: Bewegen Sie ihn einmal an seinem eigenen Bediengerät.</translation>
    </message>
</context>
<context>
    <name>seamwright::ListHabits</name>
    <message>
        <source>Copy rows</source>
        <translation>Zeilen kopieren</translation>
    </message>
</context>
<context>
    <name>seamwright::MainWindow</name>
    <message>
        <source>%1. Afterwards: %2</source>
        <translation>%1. Danach: %2</translation>
    </message>
    <message>
        <source>A job is running: end it first, the window is built anew for this.</source>
        <translation>Es läuft ein Auftrag: erst beenden, das Fenster wird dafür neu aufgebaut.</translation>
    </message>
    <message>
        <source>%1 is there already. Replace it and all that it holds?</source>
        <translation>%1 gibt es schon. Mit allem, was darin ist, ersetzen?</translation>
    </message>
    <message>
        <source>A value is refused: mend it, or press Esc in its field.</source>
        <translation>Ein Wert wurde abgelehnt: berichtigen, oder in seinem Feld Esc drücken.</translation>
    </message>
    <message>
        <source>Record what the devices deliver...</source>
        <translation>Aufzeichnen, was die Geräte liefern...</translation>
    </message>
    <message>
        <source>Gap along a path...</source>
        <translation>Spalt entlang einer Bahn...</translation>
    </message>
    <message>
        <source>Path corrected by a run...</source>
        <translation>Von einem Lauf korrigierte Bahn...</translation>
    </message>
    <message>
        <source>Program for the robot&apos;s controller...</source>
        <translation>Programm für die Robotersteuerung...</translation>
    </message>
    <message>
        <source>Sign in...</source>
        <translation>Anmelden...</translation>
    </message>
    <message>
        <source>Sign out</source>
        <translation>Abmelden</translation>
    </message>
    <message>
        <source>Sign out by itself...</source>
        <translation>Von selbst abmelden...</translation>
    </message>
    <message>
        <source>Sign out by itself</source>
        <translation>Von selbst abmelden</translation>
    </message>
    <message>
        <source>Minutes without mouse and keyboard; 0: never</source>
        <translation>Minuten ohne Maus und Tastatur; 0: nie</translation>
    </message>
    <message>
        <source>Who is signed in</source>
        <translation>Wer angemeldet ist</translation>
    </message>
    <message>
        <source>nobody signed in</source>
        <translation>niemand angemeldet</translation>
    </message>
    <message>
        <source>Signed out: nobody worked for %1 minutes.</source>
        <translation>Abgemeldet: %1 Minuten lang hat niemand gearbeitet.</translation>
    </message>
    <message>
        <source>The project has no users: nobody is asked. &quot;seamwright user add&quot; adds one.</source>
        <translation>Das Projekt hat keine Benutzer: niemand wird gefragt. „seamwright user add“ legt einen an.</translation>
    </message>
    <message>
        <source>autosaved %1</source>
        <translation>automatisch gesichert %1</translation>
    </message>
    <message>
        <source>saved</source>
        <translation>gespeichert</translation>
    </message>
    <message>
        <source>&amp;File</source>
        <translation>&amp;Datei</translation>
    </message>
    <message>
        <source>&amp;New project...</source>
        <translation>&amp;Neues Projekt...</translation>
    </message>
    <message>
        <source>&amp;Open...</source>
        <translation>Ö&amp;ffnen...</translation>
    </message>
    <message>
        <source>Recent</source>
        <translation>Zuletzt benutzt</translation>
    </message>
    <message>
        <source>&amp;Save</source>
        <translation>&amp;Speichern</translation>
    </message>
    <message>
        <source>Save &amp;as...</source>
        <translation>Speichern &amp;unter...</translation>
    </message>
    <message>
        <source>Import project (JSON)...</source>
        <translation>Projekt einlesen (JSON)...</translation>
    </message>
    <message>
        <source>Export project (JSON)...</source>
        <translation>Projekt ausgeben (JSON)...</translation>
    </message>
    <message>
        <source>Open the demo project</source>
        <translation>Das Demoprojekt öffnen</translation>
    </message>
    <message>
        <source>Start the demo project anew</source>
        <translation>Das Demoprojekt neu beginnen</translation>
    </message>
    <message>
        <source>Demo project</source>
        <translation>Demoprojekt</translation>
    </message>
    <message>
        <source>Replace your demo project and its runs by a fresh one?</source>
        <translation>Ihr Demoprojekt samt Läufen durch ein frisches ersetzen?</translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation>&amp;Beenden</translation>
    </message>
    <message>
        <source>&amp;Edit</source>
        <translation>&amp;Bearbeiten</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wiederholen</translation>
    </message>
    <message>
        <source>All actions...</source>
        <translation>Alle Aktionen...</translation>
    </message>
    <message>
        <source>&amp;Steps</source>
        <translation>S&amp;chritte</translation>
    </message>
    <message>
        <source>Step %1: %2</source>
        <translation>Schritt %1: %2</translation>
    </message>
    <message>
        <source>Go to the next step</source>
        <translation>Zum nächsten Schritt</translation>
    </message>
    <message>
        <source>&amp;Measure</source>
        <translation>&amp;Messen</translation>
    </message>
    <message>
        <source>Connect devices</source>
        <translation>Geräte verbinden</translation>
    </message>
    <message>
        <source>Disconnect devices</source>
        <translation>Geräte trennen</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Measure, then push...</source>
        <translation>Messen, dann übertragen...</translation>
    </message>
    <message>
        <source>Cancel the measuring</source>
        <translation>Das Messen abbrechen</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>&amp;Ansicht</translation>
    </message>
    <message>
        <source>Show %1</source>
        <translation>%1 zeigen</translation>
    </message>
    <message>
        <source>One view alone, and back</source>
        <translation>Eine Ansicht allein, und zurück</translation>
    </message>
    <message>
        <source>Freeze the live profile, and go on</source>
        <translation>Das laufende Profil anhalten, und weiter</translation>
    </message>
    <message>
        <source>Docks as at first</source>
        <translation>Ansichten wie am Anfang</translation>
    </message>
    <message>
        <source>Deutsch</source>
        <translation>English</translation>
    </message>
    <message>
        <source>Light theme</source>
        <translation>Helles Schema</translation>
    </message>
    <message>
        <source>Dark theme</source>
        <translation>Dunkles Schema</translation>
    </message>
    <message>
        <source>Tools</source>
        <translation>Werkzeuge</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Mehr</translation>
    </message>
    <message>
        <source>This view alone, and back (F11)</source>
        <translation>Diese Ansicht allein, und zurück (F11)</translation>
    </message>
    <message>
        <source>In a window of its own, and back</source>
        <translation>In einem eigenen Fenster, und zurück</translation>
    </message>
    <message>
        <source>Live profile</source>
        <translation>Laufendes Profil</translation>
    </message>
    <message>
        <source>Camera image</source>
        <translation>Kamerabild</translation>
    </message>
    <message>
        <source>Part in 3D</source>
        <translation>Teil in 3D</translation>
    </message>
    <message>
        <source>Frozen contour</source>
        <translation>Stehende Kontur</translation>
    </message>
    <message>
        <source>Residuals</source>
        <translation>Residuen</translation>
    </message>
    <message>
        <source>Charts</source>
        <translation>Diagramme</translation>
    </message>
    <message>
        <source>Events</source>
        <translation>Ereignisse</translation>
    </message>
    <message>
        <source>Understood</source>
        <translation>Verstanden</translation>
    </message>
    <message>
        <source>Puts the message away; the event log keeps it</source>
        <translation>Räumt die Meldung weg; das Ereignisprotokoll behält sie</translation>
    </message>
    <message>
        <source>Sensors: state, rate, dropped frames</source>
        <translation>Sensoren: Zustand, Rate, verlorene Bilder</translation>
    </message>
    <message>
        <source>Robots: mode and state</source>
        <translation>Roboter: Betriebsart und Zustand</translation>
    </message>
    <message>
        <source>The last push</source>
        <translation>Die letzte Übertragung</translation>
    </message>
    <message>
        <source>Alarms and refusals in the event log</source>
        <translation>Alarme und Ablehnungen im Ereignisprotokoll</translation>
    </message>
    <message>
        <source>Whether edits are saved</source>
        <translation>Ob Änderungen gespeichert sind</translation>
    </message>
    <message>
        <source>%1[*] - Seamwright</source>
        <translation>%1[*] - Seamwright</translation>
    </message>
    <message>
        <source>no project</source>
        <translation>kein Projekt</translation>
    </message>
    <message>
        <source>Next: %1 - %2</source>
        <translation>Als Nächstes: %1 - %2</translation>
    </message>
    <message>
        <source>sensor %1 ok %2 /s, %3 dropped</source>
        <translation>Sensor %1 ok %2 /s, %3 verloren</translation>
    </message>
    <message>
        <source>sensor %1 no frame</source>
        <translation>Sensor %1 kein Bild</translation>
    </message>
    <message>
        <source>sensor %1 measures</source>
        <translation>Sensor %1 misst</translation>
    </message>
    <message>
        <source>robot %1 %2 ok</source>
        <translation>Roboter %1 %2 ok</translation>
    </message>
    <message>
        <source>robot %1 silent</source>
        <translation>Roboter %1 stumm</translation>
    </message>
    <message>
        <source>not connected</source>
        <translation>nicht verbunden</translation>
    </message>
    <message>
        <source>last push %1, run %2 verified</source>
        <translation>letzte Übertragung %1, Lauf %2 geprüft</translation>
    </message>
    <message>
        <source>nothing pushed</source>
        <translation>nichts übertragen</translation>
    </message>
    <message>
        <source>Unsaved edits</source>
        <translation>Nicht gespeicherte Änderungen</translation>
    </message>
    <message>
        <source>%1 has unsaved edits.</source>
        <translation>%1 hat nicht gespeicherte Änderungen.</translation>
    </message>
    <message>
        <source>New project</source>
        <translation>Neues Projekt</translation>
    </message>
    <message>
        <source>Seamwright projects (*.seam)</source>
        <translation>Seamwright-Projekte (*.seam)</translation>
    </message>
    <message>
        <source>Open project</source>
        <translation>Projekt öffnen</translation>
    </message>
    <message>
        <source>Save as</source>
        <translation>Speichern unter</translation>
    </message>
    <message>
        <source>Export project</source>
        <translation>Projekt ausgeben</translation>
    </message>
    <message>
        <source>JSON (*.json)</source>
        <translation>JSON (*.json)</translation>
    </message>
    <message>
        <source>Import project</source>
        <translation>Projekt einlesen</translation>
    </message>
    <message>
        <source>Save the imported project as</source>
        <translation>Das eingelesene Projekt speichern als</translation>
    </message>
    <message>
        <source>Hand-over report...</source>
        <translation>Übergabebericht...</translation>
    </message>
    <message>
        <source>Clone for the mirrored part...</source>
        <translation>Kopie für das gespiegelte Teil...</translation>
    </message>
    <message>
        <source>After an exchange of sensor or robot...</source>
        <translation>Nach Austausch von Sensor oder Roboter...</translation>
    </message>
    <message>
        <source>Hand-over report</source>
        <translation>Übergabebericht</translation>
    </message>
    <message>
        <source>PDF (*.pdf);;HTML (*.html)</source>
        <translation>PDF (*.pdf);;HTML (*.html)</translation>
    </message>
    <message>
        <source>The report is in %1</source>
        <translation>Der Bericht steht in %1</translation>
    </message>
    <message>
        <source>Save the mirrored project as</source>
        <translation>Gespiegeltes Projekt speichern unter</translation>
    </message>
    <message>
        <source>Choose another name: the original stays.</source>
        <translation>Einen anderen Namen wählen: das Original bleibt.</translation>
    </message>
    <message>
        <source>This is the mirrored clone. Drive its spots slowly once, and teach their references again.</source>
        <translation>Dies ist die gespiegelte Kopie. Ihre Messstellen einmal langsam anfahren und die Referenzen neu einlernen.</translation>
    </message>
    <message>
        <source>%1 spots were led along. Drive each slowly once, then repeat the zero shift.</source>
        <translation>%1 Messstellen wurden nachgeführt. Jede einmal langsam anfahren, dann die Nullverschiebung wiederholen.</translation>
    </message>
    <message>
        <source>The project was not saved.</source>
        <translation>Das Projekt wurde nicht gespeichert.</translation>
    </message>
    <message>
        <source>The file was not written.</source>
        <translation>Die Datei wurde nicht geschrieben.</translation>
    </message>
    <message>
        <source>Nothing was imported.</source>
        <translation>Nichts wurde importiert.</translation>
    </message>
    <message>
        <source>The project was not made.</source>
        <translation>Das Projekt wurde nicht angelegt.</translation>
    </message>
    <message>
        <source>There is no report.</source>
        <translation>Es gibt keinen Bericht.</translation>
    </message>
    <message>
        <source>sensor %1 no frame since %2 s</source>
        <translation>Sensor %1 kein Bild seit %2 s</translation>
    </message>
    <message>
        <source>robot %1 no answer since %2 s</source>
        <translation>Roboter %1 keine Antwort seit %2 s</translation>
    </message>
    <message>
        <source>Move the robot by hand</source>
        <translation>Roboter von Hand bewegen</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>&amp;Hilfe</translation>
    </message>
    <message>
        <source>About Seamwright</source>
        <translation>Über Seamwright</translation>
    </message>
    <message>
        <source>Jog</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Manual of this page</source>
        <translation>Handbuch zu dieser Seite</translation>
    </message>
    <message>
        <source>Manual</source>
        <translation>Handbuch</translation>
    </message>
    <message>
        <source>Manual: %1</source>
        <translation>Handbuch: %1</translation>
    </message>
    <message>
        <source>Spots from the drawing...</source>
        <translation>Messstellen aus der Zeichnung...</translation>
    </message>
    <message>
        <source>Fit a panel...</source>
        <translation>Anbauteil einpassen...</translation>
    </message>
    <message>
        <source>A push waits for your answer: go to Run</source>
        <translation>Eine Übertragung wartet auf Ihre Antwort: zum Lauf</translation>
    </message>
    <message>
        <source>Answer above: push, or do not push</source>
        <translation>Oben antworten: übertragen oder nicht übertragen</translation>
    </message>
    <message>
        <source>A job is running</source>
        <translation>Ein Auftrag läuft</translation>
    </message>
    <message>
        <source>A push waits for your answer. When the project is closed, nothing is pushed.</source>
        <translation>Eine Übertragung wartet auf Ihre Antwort. Wird das Projekt geschlossen, wird nichts übertragen.</translation>
    </message>
    <message>
        <source>A job is running. When the project is closed, it is cancelled and what it has measured so far may be lost.</source>
        <translation>Ein Auftrag läuft. Wird das Projekt geschlossen, wird er abgebrochen, und was er bis dahin gemessen hat, kann verloren gehen.</translation>
    </message>
    <message>
        <source>Cancel the job and close</source>
        <translation>Auftrag abbrechen und schließen</translation>
    </message>
    <message>
        <source>Stay</source>
        <translation>Bleiben</translation>
    </message>
    <message>
        <source>Open a project, or make a new one in the menu File</source>
        <translation>Ein Projekt öffnen, oder im Menü Datei ein neues anlegen</translation>
    </message>
</context>
<context>
    <name>seamwright::ManualWindow</name>
    <message>
        <source>Manual</source>
        <translation>Handbuch</translation>
    </message>
    <message>
        <source>Search the manual</source>
        <translation>Im Handbuch suchen</translation>
    </message>
    <message>
        <source>Only the pages with these words stay in the list</source>
        <translation>Nur die Seiten mit diesen Wörtern bleiben in der Liste</translation>
    </message>
    <message>
        <source>Pages of the manual</source>
        <translation>Seiten des Handbuchs</translation>
    </message>
    <message>
        <source>The page</source>
        <translation>Die Seite</translation>
    </message>
    <message>
        <source>Back</source>
        <translation>Zurück</translation>
    </message>
    <message>
        <source>The page that was read before (Alt+Left)</source>
        <translation>Die zuvor gelesene Seite (Alt+Links)</translation>
    </message>
</context>
<context>
    <name>seamwright::MethodDrawing</name>
    <message>
        <source>Drawing of the set-up</source>
        <translation>Zeichnung des Aufbaus</translation>
    </message>
</context>
<context>
    <name>seamwright::MirrorDialog</name>
    <message>
        <source>Clone for the mirrored part</source>
        <translation>Kopie für das gespiegelte Teil</translation>
    </message>
    <message>
        <source>Makes a second project, as the left door becomes the right one: spots, features, regions and frames are reflected in a plane of the work object. Sensors, robots and calibrations stay. Runs and proofs stay with this project.</source>
        <translation>Macht ein zweites Projekt, wie aus der linken Tür die rechte wird: Messstellen, Merkmale, Korrekturbereiche und Frames werden an einer Ebene des Werkobjekts gespiegelt. Sensoren, Roboter und Kalibrierungen bleiben. Läufe und Nachweise bleiben bei diesem Projekt.</translation>
    </message>
    <message>
        <source>X changes its sign</source>
        <translation>X wechselt das Vorzeichen</translation>
    </message>
    <message>
        <source>Y changes its sign</source>
        <translation>Y wechselt das Vorzeichen</translation>
    </message>
    <message>
        <source>Z changes its sign</source>
        <translation>Z wechselt das Vorzeichen</translation>
    </message>
    <message>
        <source>Plane</source>
        <translation>Ebene</translation>
    </message>
    <message>
        <source>The axis of the work object that the plane stands across</source>
        <translation>Die Achse des Werkobjekts, zu der die Ebene quer steht</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>Its distance</source>
        <translation>Ihr Abstand</translation>
    </message>
    <message>
        <source>From the work object&apos;s origin, along that axis</source>
        <translation>Vom Ursprung des Werkobjekts, entlang dieser Achse</translation>
    </message>
    <message>
        <source>Make the clone</source>
        <translation>Kopie machen</translation>
    </message>
    <message>
        <source>Asks for its file</source>
        <translation>Fragt nach ihrer Datei</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Nothing is made</source>
        <translation>Nichts wird gemacht</translation>
    </message>
</context>
<context>
    <name>seamwright::NameEditor</name>
    <message>
        <source>Why the name is refused</source>
        <translation>Warum der Name abgelehnt wird</translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation>abgelehnt: %1</translation>
    </message>
</context>
<context>
    <name>seamwright::ParameterEditor</name>
    <message>
        <source>%1 to %2 %3</source>
        <translation>%1 bis %2 %3</translation>
    </message>
    <message>
        <source>Why the value is refused</source>
        <translation>Warum der Wert abgelehnt wird</translation>
    </message>
    <message>
        <source>not a number</source>
        <translation>keine Zahl</translation>
    </message>
    <message>
        <source>outside %1</source>
        <translation>außerhalb %1</translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation>abgelehnt: %1</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is refused: %2. %3 stays.</source>
        <translation>„%1“ wird abgelehnt: %2. %3 bleibt.</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is not a number; give %2</source>
        <translation>„%1“ ist keine Zahl; anzugeben ist %2</translation>
    </message>
    <message>
        <source>&quot;%1&quot; has another unit; give %2</source>
        <translation>„%1“ hat eine andere Einheit; anzugeben ist %2</translation>
    </message>
    <message>
        <source>%1 Nothing was begun: press again to go on with it.</source>
        <translation>%1 Nichts wurde begonnen: noch einmal drücken, um damit fortzufahren.</translation>
    </message>
</context>
<context>
    <name>seamwright::PoseEditor</name>
    <message>
        <source>%1: &quot;%2&quot; is not a number</source>
        <translation>%1: „%2“ ist keine Zahl</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>deg</source>
        <translation>Grad</translation>
    </message>
    <message>
        <source>rad</source>
        <translation>rad</translation>
    </message>
    <message>
        <source>%1 in %2. A whole pose can be pasted here.</source>
        <translation>%1 in %2. Eine ganze Pose kann hier eingefügt werden.</translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation>abgelehnt: %1</translation>
    </message>
    <message>
        <source>Pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <source>Position in mm and orientation in the notation chosen</source>
        <translation>Position in mm und Orientierung in der gewählten Schreibweise</translation>
    </message>
    <message>
        <source>Notation of the orientation</source>
        <translation>Schreibweise der Orientierung</translation>
    </message>
    <message>
        <source>How the orientation is written; the pose itself stays</source>
        <translation>Wie die Orientierung geschrieben wird; die Pose selbst bleibt</translation>
    </message>
    <message>
        <source>Matrix, 4 rows of 4 numbers, mm</source>
        <translation>Matrix, 4 Zeilen zu 4 Zahlen, mm</translation>
    </message>
    <message>
        <source>Paste or type 12 or 16 numbers, row by row; Ctrl+Enter takes them</source>
        <translation>12 oder 16 Zahlen zeilenweise einfügen oder tippen; Strg+Enter übernimmt sie</translation>
    </message>
    <message>
        <source>Why the pose is refused</source>
        <translation>Warum die Pose abgelehnt wird</translation>
    </message>
    <message>
        <source>a number in %1</source>
        <translation>eine Zahl in %1</translation>
    </message>
    <message>
        <source>give millimetres and degrees</source>
        <translation>Millimeter und Grad angeben</translation>
    </message>
    <message>
        <source>a pose of %1 numbers</source>
        <translation>eine Pose aus %1 Zahlen</translation>
    </message>
    <message>
        <source>give 6 numbers, 7 with a quaternion, 12 or 16 as a matrix</source>
        <translation>6 Zahlen angeben, 7 mit Quaternion, 12 oder 16 als Matrix</translation>
    </message>
    <message>
        <source>KUKA A B C (Z-Y&apos;-X&apos;&apos;)</source>
        <translation>KUKA A B C (Z-Y&apos;-X&apos;&apos;)</translation>
    </message>
    <message>
        <source>FANUC W P R</source>
        <translation>FANUC W P R</translation>
    </message>
    <message>
        <source>ABB quaternion (w first)</source>
        <translation>ABB-Quaternion (w zuerst)</translation>
    </message>
    <message>
        <source>UR rotation vector</source>
        <translation>UR-Rotationsvektor</translation>
    </message>
    <message>
        <source>Matrix 4 x 4</source>
        <translation>Matrix 4 x 4</translation>
    </message>
    <message>
        <source>%1: &quot;%2&quot; has another unit; give it in %3</source>
        <translation>%1: „%2“ hat eine andere Einheit; in %3 angeben</translation>
    </message>
    <message numerus="yes">
        <source>%n pose(s), one a line</source>
        <translation>
            <numerusform>%n Pose</numerusform>
            <numerusform>%n Posen, eine je Zeile</numerusform>
        </translation>
    </message>
    <message>
        <source>give one of them</source>
        <translation>eine davon angeben</translation>
    </message>
    <message>
        <source>an angle of %1 degrees</source>
        <translation>ein Winkel von %1 Grad</translation>
    </message>
    <message>
        <source>give degrees from -360 to 360</source>
        <translation>Grad von -360 bis 360 angeben</translation>
    </message>
</context>
<context>
    <name>seamwright::ProfilePlot</name>
    <message>
        <source>x (mm)</source>
        <translation>x (mm)</translation>
    </message>
    <message>
        <source>z (mm)</source>
        <translation>z (mm)</translation>
    </message>
    <message>
        <source>intensity, up to %1</source>
        <translation>Helligkeit, bis %1</translation>
    </message>
    <message>
        <source>reference</source>
        <translation>Referenz</translation>
    </message>
    <message>
        <source>x %1 ± %2   z %3 ± %4 mm (2 sigma)</source>
        <translation>x %1 ± %2   z %3 ± %4 mm (2 Sigma)</translation>
    </message>
    <message>
        <source>no feature: %1</source>
        <translation>kein Merkmal: %1</translation>
    </message>
    <message>
        <source>%1 mm   %2°   (dx %3, dz %4)</source>
        <translation>%1 mm   %2°   (dx %3, dz %4)</translation>
    </message>
    <message>
        <source>residuals:
no reference here</source>
        <translation>Residuen:
hier keine Referenz</translation>
    </message>
    <message>
        <source>to reference %1 ± %2 mm</source>
        <translation>zur Referenz %1 ± %2 mm</translation>
    </message>
    <message>
        <source>Live profile</source>
        <translation>Laufendes Profil</translation>
    </message>
    <message>
        <source>Profile in the sensor frame, mm. Drag moves, wheel zooms, double click or F fits, Space freezes, M measures.</source>
        <translation>Profil in Sensorkoordinaten, mm. Ziehen verschiebt, Rad zoomt, Doppelklick oder F passt ein, Leertaste hält an, M misst.</translation>
    </message>
    <message>
        <source>Profile, x and z in mm</source>
        <translation>Profil, x und z in mm</translation>
    </message>
    <message>
        <source>Sensor state</source>
        <translation>Zustand des Sensors</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>Show all points (F)</source>
        <translation>Alle Punkte zeigen (F)</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Two clicks: distance and angle (M)</source>
        <translation>Zwei Klicks: Abstand und Winkel (M)</translation>
    </message>
    <message>
        <source>Residuals</source>
        <translation>Residuen</translation>
    </message>
    <message>
        <source>Histogram of the distances to the reference profile</source>
        <translation>Histogramm der Abstände zum Referenzprofil</translation>
    </message>
    <message>
        <source>Intensity</source>
        <translation>Helligkeit</translation>
    </message>
    <message>
        <source>Brightness of the stripe along x</source>
        <translation>Helligkeit des Streifens über x</translation>
    </message>
    <message>
        <source>Freeze</source>
        <translation>Anhalten</translation>
    </message>
    <message>
        <source>Hold this profile on the screen (Space)</source>
        <translation>Dieses Profil auf dem Schirm halten (Leertaste)</translation>
    </message>
    <message>
        <source>Frozen</source>
        <translation>Angehalten</translation>
    </message>
</context>
<context>
    <name>seamwright::ProvePage</name>
    <message>
        <source>What makes the region uncertain</source>
        <translation>Woraus die Unsicherheit des Korrekturbereichs besteht</translation>
    </message>
    <message>
        <source>Runs</source>
        <translation>Läufe</translation>
    </message>
    <message>
        <source>How often the unmoved part is measured</source>
        <translation>Wie oft das unbewegte Teil gemessen wird</translation>
    </message>
    <message>
        <source>Start zero shift</source>
        <translation>Nullverschiebung starten</translation>
    </message>
    <message>
        <source>Measures; nothing is written to the robot</source>
        <translation>Misst; zum Roboter wird nichts geschrieben</translation>
    </message>
    <message>
        <source>Region</source>
        <translation>Korrekturbereich</translation>
    </message>
    <message>
        <source>Direction</source>
        <translation>Richtung</translation>
    </message>
    <message>
        <source>Mean</source>
        <translation>Mittel</translation>
    </message>
    <message>
        <source>3 sigma</source>
        <translation>3 Sigma</translation>
    </message>
    <message>
        <source>Mean and scatter over the zero-shift runs</source>
        <translation>Mittel und Streuung über die Nullverschiebungsläufe</translation>
    </message>
    <message>
        <source>The mean tells bias, 3 sigma the repeatability; stated is what the correction itself claims. The charts beside show every run.</source>
        <translation>Das Mittel zeigt die Abweichung, 3 Sigma die Wiederholgenauigkeit; angegeben ist, was die Korrektur selbst behauptet. Die Diagramme daneben zeigen jeden Lauf.</translation>
    </message>
    <message>
        <source>X</source>
        <translation>X</translation>
    </message>
    <message>
        <source>Y</source>
        <translation>Y</translation>
    </message>
    <message>
        <source>Z</source>
        <translation>Z</translation>
    </message>
    <message>
        <source>A about Z</source>
        <translation>A um Z</translation>
    </message>
    <message>
        <source>B about Y</source>
        <translation>B um Y</translation>
    </message>
    <message>
        <source>C about X</source>
        <translation>C um X</translation>
    </message>
    <message>
        <source>not measured yet</source>
        <translation>noch nicht gemessen</translation>
    </message>
    <message>
        <source>%1 of %2 runs were refused</source>
        <translation>%1 von %2 Läufen wurden abgelehnt</translation>
    </message>
    <message>
        <source>Zero shift of region %1</source>
        <translation>Nullverschiebung von Korrekturbereich %1</translation>
    </message>
    <message>
        <source>Zero shift, X Y Z</source>
        <translation>Nullverschiebung, X Y Z</translation>
    </message>
    <message>
        <source>Before anything is corrected: the part as taught reads zero, known shifts are found again, and the run works without this screen.</source>
        <translation>Bevor etwas korrigiert wird: das Teil wie eingelernt ergibt null, bekannte Verschiebungen werden wiedergefunden, und der Lauf geht ohne diesen Bildschirm.</translation>
    </message>
    <message>
        <source>Zero shift</source>
        <translation>Nullverschiebung</translation>
    </message>
    <message>
        <source>The region that the tables and the charts show</source>
        <translation>Der Korrekturbereich, den Tabellen und Diagramme zeigen</translation>
    </message>
    <message>
        <source>Known shift</source>
        <translation>Bekannte Verschiebung</translation>
    </message>
    <message>
        <source>The part is displaced by known amounts along and about X, Y and Z, measured each time, and what is found is compared with what was done.</source>
        <translation>Das Teil wird um bekannte Beträge entlang und um X, Y und Z verschoben, jedes Mal gemessen, und das Gefundene mit dem Getanen verglichen.</translation>
    </message>
    <message>
        <source>the simulated part moves</source>
        <translation>das simulierte Teil bewegt sich</translation>
    </message>
    <message>
        <source>the robot&apos;s base is shifted from here</source>
        <translation>die Basis des Roboters wird von hier verschoben</translation>
    </message>
    <message>
        <source>I shift the base or the part</source>
        <translation>ich verschiebe die Basis oder das Teil</translation>
    </message>
    <message>
        <source>How</source>
        <translation>Wie</translation>
    </message>
    <message>
        <source>A base shift looks to the sensor as if the part had moved. Controllers that hold their own program are shifted by hand.</source>
        <translation>Eine Basisverschiebung sieht für den Sensor aus, als hätte sich das Teil bewegt. Steuerungen mit eigenem Programm werden von Hand verschoben.</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source> deg</source>
        <translation> Grad</translation>
    </message>
    <message>
        <source>Translation up to</source>
        <translation>Verschiebung bis</translation>
    </message>
    <message>
        <source>Both ways, each axis</source>
        <translation>In beide Richtungen, jede Achse</translation>
    </message>
    <message>
        <source>in steps of</source>
        <translation>in Schritten von</translation>
    </message>
    <message>
        <source>Smaller steps measure more often</source>
        <translation>Kleinere Schritte messen öfter</translation>
    </message>
    <message>
        <source>Rotation up to</source>
        <translation>Drehung bis</translation>
    </message>
    <message>
        <source>Both ways, about each axis through the middle of the spots</source>
        <translation>In beide Richtungen, um jede Achse durch die Mitte der Messstellen</translation>
    </message>
    <message>
        <source>Start known shift</source>
        <translation>Bekannte Verschiebung starten</translation>
    </message>
    <message>
        <source>Measures every displacement; nothing is written to the robot</source>
        <translation>Misst jede Verschiebung; nichts wird an den Roboter geschrieben</translation>
    </message>
    <message>
        <source>In the charts</source>
        <translation>In den Diagrammen</translation>
    </message>
    <message>
        <source>Deviation against displacement in the charts beside</source>
        <translation>Abweichung über der Verschiebung in den Diagrammen daneben</translation>
    </message>
    <message>
        <source>It stands</source>
        <translation>Es steht</translation>
    </message>
    <message>
        <source>Measure this displacement</source>
        <translation>Diese Verschiebung messen</translation>
    </message>
    <message>
        <source>End</source>
        <translation>Beenden</translation>
    </message>
    <message>
        <source>Measure no further displacement</source>
        <translation>Keine weitere Verschiebung messen</translation>
    </message>
    <message>
        <source>Displacement</source>
        <translation>Verschiebung</translation>
    </message>
    <message>
        <source>Tests</source>
        <translation>Versuche</translation>
    </message>
    <message>
        <source>3 rms</source>
        <translation>3 rms</translation>
    </message>
    <message>
        <source>Deviation of the spots&apos; reference points, found minus true, mm; 3 rms counts the mean as error too</source>
        <translation>Abweichung der Referenzpunkte der Messstellen, gefunden minus wahr, mm; 3 rms zählt auch das Mittel als Fehler</translation>
    </message>
    <message>
        <source>Commissioning</source>
        <translation>Inbetriebnahme</translation>
    </message>
    <message>
        <source>Step</source>
        <translation>Schritt</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Stand</translation>
    </message>
    <message>
        <source>Every step of commissioning, derived</source>
        <translation>Jeder Schritt der Inbetriebnahme, abgeleitet</translation>
    </message>
    <message>
        <source>Open its page</source>
        <translation>Seine Seite öffnen</translation>
    </message>
    <message>
        <source>Where this step is worked on</source>
        <translation>Wo an diesem Schritt gearbeitet wird</translation>
    </message>
    <message>
        <source>Hand-over report...</source>
        <translation>Übergabebericht...</translation>
    </message>
    <message>
        <source>PDF or HTML: devices, calibrations, spots, proofs, limits, events</source>
        <translation>PDF oder HTML: Geräte, Kalibrierungen, Messstellen, Nachweise, Grenzen, Ereignisse</translation>
    </message>
    <message>
        <source>%1 runs: the mean moves a spot by %2 mm, more than required</source>
        <translation>%1 Läufe: das Mittel verschiebt eine Messstelle um %2 mm, mehr als gefordert</translation>
    </message>
    <message>
        <source>%1 runs read zero: the mean moves no spot by more than %2 mm</source>
        <translation>%1 Läufe ergeben null: das Mittel verschiebt keine Messstelle um mehr als %2 mm</translation>
    </message>
    <message>
        <source>translation</source>
        <translation>Verschiebung</translation>
    </message>
    <message>
        <source>rotation</source>
        <translation>Drehung</translation>
    </message>
    <message>
        <source>both</source>
        <translation>beides</translation>
    </message>
    <message>
        <source>%1, %2 refused</source>
        <translation>%1, %2 abgelehnt</translation>
    </message>
    <message>
        <source>Region %1: %2 of %3 displacements were refused</source>
        <translation>Korrekturbereich %1: %2 von %3 Verschiebungen wurden abgelehnt</translation>
    </message>
    <message>
        <source>Region %1: recovered, 3 rms %2 mm of %3 mm</source>
        <translation>Korrekturbereich %1: wiedergefunden, 3 rms %2 mm von %3 mm</translation>
    </message>
    <message>
        <source>Region %1: not recovered, 3 rms %2 mm of %3 mm</source>
        <translation>Korrekturbereich %1: nicht wiedergefunden, 3 rms %2 mm von %3 mm</translation>
    </message>
    <message>
        <source>mean deviation</source>
        <translation>mittlere Abweichung</translation>
    </message>
    <message>
        <source>Known shift of region %1</source>
        <translation>Bekannte Verschiebung von Korrekturbereich %1</translation>
    </message>
    <message>
        <source>Deviations X Y Z at the spots</source>
        <translation>Abweichungen X Y Z an den Messstellen</translation>
    </message>
    <message>
        <source>%1
Set the controller&apos;s base shift to
X %2  Y %3  Z %4 mm
A %5  B %6  C %7 deg</source>
        <translation>%1
Die Basisverschiebung der Steuerung setzen auf
X %2  Y %3  Z %4 mm
A %5  B %6  C %7 Grad</translation>
    </message>
    <message>
        <source>Stated</source>
        <translation>Angabe</translation>
    </message>
</context>
<context>
    <name>seamwright::RegionsPage</name>
    <message>
        <source>Pick 3-2-1 on the part</source>
        <translation>3-2-1 am Teil anklicken</translation>
    </message>
    <message>
        <source>Six clicks on the part in 3D: three on a plane, two along X, one for the origin; the frame goes there</source>
        <translation>Sechs Klicks auf das Teil in 3D: drei auf einer Ebene, zwei entlang X, einer für den Ursprung; der Frame kommt dorthin</translation>
    </message>
    <message>
        <source>There is no part to click on: step 1, Cell, imports its mesh.</source>
        <translation>Es gibt kein Teil zum Anklicken: Schritt 1, Zelle, importiert sein Netz.</translation>
    </message>
    <message>
        <source>click point %1 of 3 of the plane, counter-clockwise seen from above</source>
        <translation>Punkt %1 von 3 der Ebene anklicken, von oben gesehen gegen den Uhrzeigersinn</translation>
    </message>
    <message>
        <source>click point %1 of 2 along X</source>
        <translation>Punkt %1 von 2 entlang X anklicken</translation>
    </message>
    <message>
        <source>click the point beside which the origin lies</source>
        <translation>den Punkt anklicken, neben dem der Ursprung liegt</translation>
    </message>
    <message>
        <source>Frame by 3-2-1: %1.</source>
        <translation>Frame nach 3-2-1: %1.</translation>
    </message>
    <message>
        <source>The frame stands where it was picked; undo brings the old one back.</source>
        <translation>Der Frame steht, wo geklickt wurde; Rückgängig bringt das alte wieder.</translation>
    </message>
    <message>
        <source>Encircle spots</source>
        <translation>Messstellen einkreisen</translation>
    </message>
    <message>
        <source>Draw a line around spots in the 3D view: they become the chosen region&apos;s, or a region of their own where none is chosen. The right mouse button does the same at any time.</source>
        <translation>Im 3D-Bild eine Linie um Messstellen ziehen: sie werden die des gewählten Korrekturbereichs oder, wo keiner gewählt ist, ein eigener Korrekturbereich. Die rechte Maustaste tut jederzeit dasselbe.</translation>
    </message>
    <message>
        <source>A region is what moves as one piece: its spots tell where it has gone, its frame is what the robot gets.</source>
        <translation>Ein Korrekturbereich ist, was sich als ein Stück bewegt: seine Messstellen sagen, wohin; seinen Frame bekommt der Roboter.</translation>
    </message>
    <message>
        <source>Regions</source>
        <translation>Korrekturbereiche</translation>
    </message>
    <message>
        <source>The project&apos;s regions</source>
        <translation>Die Korrekturbereiche des Projekts</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Another name for the region</source>
        <translation>Ein anderer Name für den Korrekturbereich</translation>
    </message>
    <message>
        <source>Rename region</source>
        <translation>Korrekturbereich umbenennen</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Take the region out; its spots stay</source>
        <translation>Den Korrekturbereich herausnehmen; seine Messstellen bleiben</translation>
    </message>
    <message>
        <source>Add region</source>
        <translation>Korrekturbereich hinzufügen</translation>
    </message>
    <message>
        <source>A further region</source>
        <translation>Ein weiterer Korrekturbereich</translation>
    </message>
    <message>
        <source>Direction</source>
        <translation>Richtung</translation>
    </message>
    <message>
        <source>Free</source>
        <translation>Frei</translation>
    </message>
    <message>
        <source>Predicted 3 sigma</source>
        <translation>Vorhergesagtes 3 Sigma</translation>
    </message>
    <message>
        <source>What the region will be able to tell</source>
        <translation>Was der Korrekturbereich wird sagen können</translation>
    </message>
    <message>
        <source>Spots of the region</source>
        <translation>Messstellen des Korrekturbereichs</translation>
    </message>
    <message>
        <source>Ticked spots belong to the region; a spot may belong to several</source>
        <translation>Angehakte Messstellen gehören zum Korrekturbereich; eine Messstelle darf zu mehreren gehören</translation>
    </message>
    <message>
        <source>spots</source>
        <translation>Messstellen</translation>
    </message>
    <message>
        <source>Free degrees of freedom (work object)</source>
        <translation>Freie Freiheitsgrade (Werkobjekt)</translation>
    </message>
    <message>
        <source>X</source>
        <translation>X</translation>
    </message>
    <message>
        <source>Y</source>
        <translation>Y</translation>
    </message>
    <message>
        <source>Z</source>
        <translation>Z</translation>
    </message>
    <message>
        <source>A about Z</source>
        <translation>A um Z</translation>
    </message>
    <message>
        <source>B about Y</source>
        <translation>B um Y</translation>
    </message>
    <message>
        <source>C about X</source>
        <translation>C um X</translation>
    </message>
    <message>
        <source>Ticked: the correction may move this way. Not ticked: exactly 0</source>
        <translation>Angehakt: die Korrektur darf sich so bewegen. Nicht angehakt: genau 0</translation>
    </message>
    <message>
        <source>degrees of freedom</source>
        <translation>Freiheitsgrade</translation>
    </message>
    <message>
        <source>Frame on the controller</source>
        <translation>Frame in der Steuerung</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>As the controller calls the base or work object that the path runs in</source>
        <translation>Wie die Steuerung die Basis oder das Werkobjekt nennt, in dem die Bahn läuft</translation>
    </message>
    <message>
        <source>frame</source>
        <translation>Frame</translation>
    </message>
    <message>
        <source>Frame as taught</source>
        <translation>Frame wie eingelernt</translation>
    </message>
    <message>
        <source>base_from_frame for the undisplaced part</source>
        <translation>base_from_frame für das nicht versetzte Teil</translation>
    </message>
    <message>
        <source>Limits</source>
        <translation>Grenzen</translation>
    </message>
    <message>
        <source>under-determined: %1</source>
        <translation>unterbestimmt: %1</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <source>exactly 0</source>
        <translation>genau 0</translation>
    </message>
    <message>
        <source>not observed</source>
        <translation>nicht beobachtet</translation>
    </message>
    <message>
        <source>A wrong measure of %1 mm could not be found at: %2</source>
        <translation>Eine Fehlmessung von %1 mm wäre nicht zu finden an: %2</translation>
    </message>
    <message>
        <source>As proven</source>
        <translation>Wie nachgewiesen</translation>
    </message>
    <message>
        <source>Lets through what the known shift has proven, and no more</source>
        <translation>Lässt durch, was die bekannten Verschiebungen nachgewiesen haben, und nicht mehr</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzen</translation>
    </message>
    <message>
        <source>observable: 3 sigma %1 mm at spot %2, %3 mm required</source>
        <translation>beobachtbar: 3 Sigma %1 mm an Messstelle %2, gefordert %3 mm</translation>
    </message>
    <message>
        <source>not sure enough: 3 sigma %1 mm at spot %2, %3 mm required</source>
        <translation>nicht sicher genug: 3 Sigma %1 mm an Messstelle %2, gefordert %3 mm</translation>
    </message>
    <message>
        <source>for parts displaced by up to %1 mm and %2 deg</source>
        <translation>für Teile, die bis %1 mm und %2 Grad verschoben sind</translation>
    </message>
    <message>
        <source>3 sigma %1 mm: %2</source>
        <translation>3 Sigma %1 mm: %2</translation>
    </message>
    <message>
        <source>Surer still would be:</source>
        <translation>Noch sicherer wäre:</translation>
    </message>
    <message>
        <source>To cure, the most effective first:</source>
        <translation>Abhilfe, das Wirksamste zuerst:</translation>
    </message>
    <message>
        <source>What makes it uncertain</source>
        <translation>Woher die Unsicherheit kommt</translation>
    </message>
    <message>
        <source>%1 (from the drawing, not confirmed)</source>
        <translation>%1 (aus der Zeichnung, nicht bestätigt)</translation>
    </message>
    <message>
        <source>%1 (of another part type, not taught on this one)</source>
        <translation>%1 (von einem anderen Teiletyp, an diesem nicht eingelernt)</translation>
    </message>
    <message>
        <source>No spot is ticked below: tick those that move with this region.</source>
        <translation>Unten ist keine Messstelle angehakt: die anhaken, die sich mit diesem Korrekturbereich bewegen.</translation>
    </message>
</context>
<context>
    <name>seamwright::ResidualBars</name>
    <message>
        <source>x</source>
        <translation>x</translation>
    </message>
    <message>
        <source>z</source>
        <translation>z</translation>
    </message>
    <message>
        <source>left out</source>
        <translation>ausgelassen</translation>
    </message>
    <message>
        <source>%1
left out</source>
        <translation>%1
ausgelassen</translation>
    </message>
    <message>
        <source>residual (mm), box 3 sigma</source>
        <translation>Residuum (mm), Kasten 3 Sigma</translation>
    </message>
    <message>
        <source>Residuals per spot</source>
        <translation>Residuen je Messstelle</translation>
    </message>
    <message>
        <source>What the correction leaves at each spot along the sensor&apos;s x and z. A click selects the spot.</source>
        <translation>Was die Korrektur an jeder Messstelle entlang x und z des Sensors übrig lässt. Ein Klick wählt die Messstelle.</translation>
    </message>
    <message>
        <source>Residual chart</source>
        <translation>Residuendiagramm</translation>
    </message>
</context>
<context>
    <name>seamwright::RunPage</name>
    <message>
        <source>%1: nothing was pushed. Open the project again.</source>
        <translation>%1: Nichts wurde übertragen. Das Projekt erneut öffnen.</translation>
    </message>
    <message>
        <source>random %1</source>
        <translation>zufällig %1</translation>
    </message>
    <message>
        <source>systematic %1</source>
        <translation>systematisch %1</translation>
    </message>
    <message>
        <source>pushed, outcome not recorded</source>
        <translation>übertragen, Ausgang nicht festgehalten</translation>
    </message>
    <message>
        <source>not taken, nothing is released</source>
        <translation>nicht übernommen, nichts ist freigegeben</translation>
    </message>
    <message>
        <source>the application runs in the frame</source>
        <translation>die Anwendung läuft im Frame</translation>
    </message>
    <message>
        <source>released, whether the application began is not known</source>
        <translation>freigegeben, ob die Anwendung begann, ist nicht bekannt</translation>
    </message>
    <message>
        <source>not released</source>
        <translation>nicht freigegeben</translation>
    </message>
    <message>
        <source>ok</source>
        <translation>ok</translation>
    </message>
    <message>
        <source>refused</source>
        <translation>abgelehnt</translation>
    </message>
    <message>
        <source>ALARM</source>
        <translation>ALARM</translation>
    </message>
    <message>
        <source>device failed</source>
        <translation>Gerät ausgefallen</translation>
    </message>
    <message>
        <source>cancelled</source>
        <translation>abgebrochen</translation>
    </message>
    <message>
        <source>interrupted</source>
        <translation>unterbrochen</translation>
    </message>
    <message>
        <source>Measure the part, look at the result, push the corrected frames.</source>
        <translation>Das Teil messen, das Ergebnis ansehen, die korrigierten Frames übertragen.</translation>
    </message>
    <message>
        <source>run number</source>
        <translation>Laufnummer</translation>
    </message>
    <message>
        <source>Part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Identity of the part that stands there; empty: the run&apos;s number</source>
        <translation>Kennung des Teils, das dort steht; leer: die Nummer des Laufs</translation>
    </message>
    <message>
        <source>Keep raw images</source>
        <translation>Rohbilder behalten</translation>
    </message>
    <message>
        <source>Camera images are stored with the run, beside the profiles</source>
        <translation>Kamerabilder werden mit dem Lauf gespeichert, neben den Profilen</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Measures and judges; nothing is written to the robot</source>
        <translation>Misst und urteilt; zum Roboter wird nichts geschrieben</translation>
    </message>
    <message>
        <source>Measure, then push...</source>
        <translation>Messen, dann übertragen...</translation>
    </message>
    <message>
        <source>Measures, shows what would be written, and asks before it is pushed</source>
        <translation>Misst, zeigt, was geschrieben würde, und fragt vor der Übertragung</translation>
    </message>
    <message>
        <source>Frame</source>
        <translation>Frame</translation>
    </message>
    <message>
        <source>X Y Z mm  A B C deg</source>
        <translation>X Y Z mm  A B C Grad</translation>
    </message>
    <message>
        <source>What would be written, and what stands there</source>
        <translation>Was geschrieben würde und was jetzt dort steht</translation>
    </message>
    <message>
        <source>Push</source>
        <translation>Übertragen</translation>
    </message>
    <message>
        <source>Writes these frames to the robot, reads them back and compares</source>
        <translation>Schreibt diese Frames zum Roboter, liest sie zurück und vergleicht</translation>
    </message>
    <message>
        <source>Do not push</source>
        <translation>Nicht übertragen</translation>
    </message>
    <message>
        <source>Nothing is written; the run is kept</source>
        <translation>Nichts wird geschrieben; der Lauf bleibt erhalten</translation>
    </message>
    <message>
        <source>Region</source>
        <translation>Bereich</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>Spot</source>
        <translation>Messstelle</translation>
    </message>
    <message>
        <source>dx mm</source>
        <translation>dx mm</translation>
    </message>
    <message>
        <source>dz mm</source>
        <translation>dz mm</translation>
    </message>
    <message>
        <source>What every spot measured against its reference</source>
        <translation>Was jede Messstelle gegen ihre Referenz gemessen hat</translation>
    </message>
    <message>
        <source>History</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <source>Run</source>
        <translation>Lauf</translation>
    </message>
    <message>
        <source>When</source>
        <translation>Wann</translation>
    </message>
    <message>
        <source>Status</source>
        <translation>Status</translation>
    </message>
    <message>
        <source>All runs of the project, newest first</source>
        <translation>Alle Läufe des Projekts, neueste zuerst</translation>
    </message>
    <message>
        <source>Show</source>
        <translation>Zeigen</translation>
    </message>
    <message>
        <source>Shows the chosen run above (Enter, double click)</source>
        <translation>Zeigt den gewählten Lauf oben (Enter, Doppelklick)</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Vergleichen</translation>
    </message>
    <message>
        <source>The chosen run beside the one shown above</source>
        <translation>Den gewählten Lauf neben dem oben gezeigten</translation>
    </message>
    <message>
        <source>Export CSV...</source>
        <translation>CSV ausgeben...</translation>
    </message>
    <message>
        <source>All runs: one line a region</source>
        <translation>Alle Läufe: eine Zeile je Korrekturbereich</translation>
    </message>
    <message>
        <source>Delete...</source>
        <translation>Löschen...</translation>
    </message>
    <message>
        <source>Deletes the chosen run with its raw data</source>
        <translation>Löscht den gewählten Lauf mit seinen Rohdaten</translation>
    </message>
    <message>
        <source>Delete run</source>
        <translation>Lauf löschen</translation>
    </message>
    <message>
        <source>Delete run %1 with its raw data? This cannot be undone.</source>
        <translation>Lauf %1 mit seinen Rohdaten löschen? Das lässt sich nicht rückgängig machen.</translation>
    </message>
    <message>
        <source>Difference X Y Z mm</source>
        <translation>Unterschied X Y Z mm</translation>
    </message>
    <message>
        <source>A B C deg</source>
        <translation>A B C Grad</translation>
    </message>
    <message>
        <source>Second run minus first</source>
        <translation>Zweiter Lauf minus erster</translation>
    </message>
    <message>
        <source>Nothing was measured yet.</source>
        <translation>Noch wurde nichts gemessen.</translation>
    </message>
    <message>
        <source>Run %1, part %2: %3</source>
        <translation>Lauf %1, Teil %2: %3</translation>
    </message>
    <message>
        <source>Run %1, part %2: %3. %4</source>
        <translation>Lauf %1, Teil %2: %3. %4</translation>
    </message>
    <message>
        <source>passed the gate</source>
        <translation>freigegeben</translation>
    </message>
    <message>
        <source>%1 ± %2</source>
        <translation>%1 ± %2</translation>
    </message>
    <message>
        <source>not solved</source>
        <translation>nicht gelöst</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1: %2</translation>
    </message>
    <message>
        <source>Safety gate: every region passes.</source>
        <translation>Sicherheitsprüfung: jeder Korrekturbereich besteht.</translation>
    </message>
    <message>
        <source>Safety gate refuses: %1</source>
        <translation>Sicherheitsprüfung lehnt ab: %1</translation>
    </message>
    <message>
        <source>%1 now</source>
        <translation>%1 jetzt</translation>
    </message>
    <message>
        <source>%1 new</source>
        <translation>%1 neu</translation>
    </message>
    <message>
        <source>These frames would be written. Nothing has been sent yet.</source>
        <translation>Diese Frames würden geschrieben. Noch ist nichts gesendet.</translation>
    </message>
    <message>
        <source>Push %1 frames to %2</source>
        <translation>%1 Frames zu %2 übertragen</translation>
    </message>
    <message>
        <source>ok, pushed</source>
        <translation>ok, übertragen</translation>
    </message>
    <message>
        <source>X</source>
        <translation>X</translation>
    </message>
    <message>
        <source>Y</source>
        <translation>Y</translation>
    </message>
    <message>
        <source>Z</source>
        <translation>Z</translation>
    </message>
    <message>
        <source>Displacement of region %1</source>
        <translation>Verschiebung von Korrekturbereich %1</translation>
    </message>
    <message>
        <source>Displacement, X Y Z</source>
        <translation>Verschiebung, X Y Z</translation>
    </message>
    <message>
        <source>Run %1 - %2: X Y Z mm</source>
        <translation>Lauf %1 - %2: X Y Z mm</translation>
    </message>
    <message>
        <source>Export CSV</source>
        <translation>CSV ausgeben</translation>
    </message>
    <message>
        <source>CSV (*.csv)</source>
        <translation>CSV (*.csv)</translation>
    </message>
    <message>
        <source>X Y Z mm</source>
        <translation>X Y Z mm</translation>
    </message>
    <message>
        <source>Displacement per region with its sigma, and what was written</source>
        <translation>Verschiebung je Korrekturbereich mit Sigma, und was geschrieben wurde</translation>
    </message>
    <message>
        <source>%1, refused</source>
        <translation>%1, abgelehnt</translation>
    </message>
    <message>
        <source>Region, verdict</source>
        <translation>Bereich, Urteil</translation>
    </message>
    <message>
        <source>Part %1 is measured and waits for your answer below.</source>
        <translation>Teil %1 ist vermessen und wartet unten auf Ihre Antwort.</translation>
    </message>
    <message numerus="yes">
        <source>%n refused</source>
        <translation>
            <numerusform>%n abgelehnt</numerusform>
            <numerusform>%n abgelehnt</numerusform>
        </translation>
    </message>
    <message>
        <source>Measuring ...</source>
        <translation>Wird gemessen ...</translation>
    </message>
    <message>
        <source>Not measured.</source>
        <translation>Nicht gemessen.</translation>
    </message>
    <message>
        <source>Left out, because they contradict the others: %1</source>
        <translation>Weggelassen, weil sie den anderen widersprechen: %1</translation>
    </message>
    <message>
        <source>Shown: run %1 of %2</source>
        <translation>Gezeigt: Lauf %1 vom %2</translation>
    </message>
    <message>
        <source>left out, contradicts by %1 mm</source>
        <translation>weggelassen, widerspricht um %1 mm</translation>
    </message>
    <message>
        <source>The project was changed while the push waited for an answer: nothing was pushed. Measure again.</source>
        <translation>Das Projekt wurde geändert, während die Übertragung auf eine Antwort wartete: nichts wurde übertragen. Neu messen.</translation>
    </message>
</context>
<context>
    <name>seamwright::SceneView</name>
    <message>
        <source>moved %1 mm</source>
        <translation>%1 mm verschoben</translation>
    </message>
    <message>
        <source>, 3 sigma %1 mm</source>
        <translation>, 3 Sigma %1 mm</translation>
    </message>
    <message>
        <source>No part yet: step 1, Cell, imports its mesh.</source>
        <translation>Noch kein Teil: Schritt 1, Zelle, importiert sein Netz.</translation>
    </message>
    <message>
        <source>next pose</source>
        <translation>nächste Pose</translation>
    </message>
    <message>
        <source>%1 (off)</source>
        <translation>%1 (aus)</translation>
    </message>
    <message>
        <source>  %1 mm</source>
        <translation>  %1 mm</translation>
    </message>
    <message>
        <source>corrections drawn × %1</source>
        <translation>Korrekturen × %1 gezeichnet</translation>
    </message>
    <message>
        <source>Part in 3D</source>
        <translation>Teil in 3D</translation>
    </message>
    <message>
        <source>Drag turns, Shift and drag moves, wheel zooms, a click selects, a drag with the right button encircles spots. 1 front, 2 top, 3 iso, F fit.</source>
        <translation>Ziehen dreht, Umschalt und Ziehen verschiebt, Rad zoomt, ein Klick wählt, Ziehen mit der rechten Taste umfährt Messstellen. 1 vorn, 2 oben, 3 iso, F einpassen.</translation>
    </message>
    <message>
        <source>Part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Front</source>
        <translation>Vorn</translation>
    </message>
    <message>
        <source>Top</source>
        <translation>Oben</translation>
    </message>
    <message>
        <source>Iso</source>
        <translation>Iso</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>View: %1</source>
        <translation>Ansicht: %1</translation>
    </message>
    <message>
        <source>Layers</source>
        <translation>Ebenen</translation>
    </message>
    <message>
        <source>What is drawn</source>
        <translation>Was gezeichnet wird</translation>
    </message>
    <message>
        <source>Spots</source>
        <translation>Messstellen</translation>
    </message>
    <message>
        <source>Sensors and laser planes</source>
        <translation>Sensoren und Laserebenen</translation>
    </message>
    <message>
        <source>Regions</source>
        <translation>Korrekturbereiche</translation>
    </message>
    <message>
        <source>Corrections</source>
        <translation>Korrekturen</translation>
    </message>
    <message>
        <source>Path before and after</source>
        <translation>Bahn vorher und nachher</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>Labels</source>
        <translation>Beschriftungen</translation>
    </message>
    <message>
        <source>No 3D picture: this display offers no OpenGL 3.2. Everything else works; measuring, correcting and pushing do not need it. Cure: a graphics driver with OpenGL 3.2, or Mesa&apos;s software renderer (LIBGL_ALWAYS_SOFTWARE=1).</source>
        <translation>Kein 3D-Bild: dieser Bildschirm bietet kein OpenGL 3.2. Alles andere geht; Messen, Korrigieren und Übertragen brauchen es nicht. Abhilfe: ein Grafiktreiber mit OpenGL 3.2 oder Mesas Softwarezeichner (LIBGL_ALWAYS_SOFTWARE=1).</translation>
    </message>
    <message>
        <source>Edges of the drawing</source>
        <translation>Kanten der Zeichnung</translation>
    </message>
</context>
<context>
    <name>seamwright::SettingsEditor</name>
    <message>
        <source>refused: %1</source>
        <translation>abgelehnt: %1</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is not a number; give %2 to %3</source>
        <translation>„%1“ ist keine Zahl; anzugeben ist %2 bis %3</translation>
    </message>
    <message>
        <source>outside %1 to %2</source>
        <translation>außerhalb %1 bis %2</translation>
    </message>
    <message>
        <source>not a whole number</source>
        <translation>keine ganze Zahl</translation>
    </message>
    <message>
        <source>not a list: [1, 2]</source>
        <translation>keine Liste: [1, 2]</translation>
    </message>
    <message>
        <source>not an object: {&quot;name&quot;: 1}</source>
        <translation>kein Objekt: {&quot;name&quot;: 1}</translation>
    </message>
    <message>
        <source>; %1 to %2</source>
        <translation>; %1 bis %2</translation>
    </message>
    <message>
        <source>; %1 if left empty</source>
        <translation>; %1, wenn leer gelassen</translation>
    </message>
    <message>
        <source>All settings of the driver</source>
        <translation>Alle Einstellungen des Treibers</translation>
    </message>
    <message>
        <source>Also what is left as the driver has it</source>
        <translation>Auch, was bleibt, wie der Treiber es vorgibt</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>Why the value is refused</source>
        <translation>Warum der Wert abgelehnt wird</translation>
    </message>
</context>
<context>
    <name>seamwright::ShareBars</name>
    <message>
        <source>Shares of the variance</source>
        <translation>Anteile an der Varianz</translation>
    </message>
    <message>
        <source>%1 % random</source>
        <translation>%1 % zufällig</translation>
    </message>
    <message>
        <source>%1 % systematic</source>
        <translation>%1 % systematisch</translation>
    </message>
</context>
<context>
    <name>seamwright::SpotHead</name>
    <message>
        <source>Moves the robot straight to the spot: look whether the way is free</source>
        <translation>Fährt den Roboter geradewegs zur Messstelle: nachsehen, ob der Weg frei ist</translation>
    </message>
    <message>
        <source>Go there</source>
        <translation>Dorthin fahren</translation>
    </message>
    <message>
        <source>What comes next of this spot</source>
        <translation>Was an dieser Messstelle als Nächstes kommt</translation>
    </message>
    <message>
        <source>Spot %1</source>
        <translation>Messstelle %1</translation>
    </message>
    <message>
        <source>No spot</source>
        <translation>Keine Messstelle</translation>
    </message>
    <message>
        <source>Jog the sensor over the contour, then add a spot there.</source>
        <translation>Den Sensor über die Kontur fahren, dann dort eine Messstelle anlegen.</translation>
    </message>
    <message>
        <source>Add spot</source>
        <translation>Messstelle hinzufügen</translation>
    </message>
    <message>
        <source>Choose one in the list.</source>
        <translation>Eine in der Liste wählen.</translation>
    </message>
    <message>
        <source>First spot</source>
        <translation>Erste Messstelle</translation>
    </message>
    <message>
        <source>Drag a window over the contour in the live profile: it becomes the template.</source>
        <translation>Im Live-Profil ein Fenster über die Kontur ziehen: es wird zur Vorlage.</translation>
    </message>
    <message>
        <source>Drag template</source>
        <translation>Vorlage ziehen</translation>
    </message>
    <message>
        <source>Its reference is not measured yet.</source>
        <translation>Ihre Referenz ist noch nicht gemessen.</translation>
    </message>
    <message>
        <source>Its reference is not measured yet: connect the devices first.</source>
        <translation>Ihre Referenz ist noch nicht gemessen: zuerst die Geräte verbinden.</translation>
    </message>
    <message>
        <source>Measure reference</source>
        <translation>Referenz messen</translation>
    </message>
    <message>
        <source>Its reference is measured, its pass is not.</source>
        <translation>Ihre Referenz ist gemessen, ihre Durchfahrt nicht.</translation>
    </message>
    <message>
        <source>Run entry -&gt; exit</source>
        <translation>Fahren: Einfahrt -&gt; Ausfahrt</translation>
    </message>
    <message>
        <source>Taught and aligned.</source>
        <translation>Eingelernt und ausgerichtet.</translation>
    </message>
    <message>
        <source>Next: spot %1</source>
        <translation>Weiter: Messstelle %1</translation>
    </message>
    <message>
        <source>All spots are taught and aligned.</source>
        <translation>Alle Messstellen sind eingelernt und ausgerichtet.</translation>
    </message>
    <message>
        <source>Next: regions</source>
        <translation>Weiter: Bereiche</translation>
    </message>
    <message>
        <source>Confirm</source>
        <translation>Bestätigen</translation>
    </message>
    <message>
        <source>From the drawing: nothing is pushed by it yet.</source>
        <translation>Aus der Zeichnung: noch wird damit nichts geschrieben.</translation>
    </message>
    <message>
        <source>From the drawing: connect, then confirm it.</source>
        <translation>Aus der Zeichnung: verbinden, dann bestätigen.</translation>
    </message>
    <message>
        <source>Its reference does not lie at its feature: measure it again.</source>
        <translation>Ihre Referenz liegt nicht an ihrem Merkmal: neu messen.</translation>
    </message>
    <message>
        <source>Its pass is recorded, not accepted.</source>
        <translation>Ihre Durchfahrt ist aufgezeichnet, nicht angenommen.</translation>
    </message>
    <message>
        <source>Accept</source>
        <translation>Annehmen</translation>
    </message>
</context>
<context>
    <name>seamwright::SpotLightPanel</name>
    <message>
        <source>merged from %1 µs</source>
        <translation>zusammengeführt aus %1 µs</translation>
    </message>
    <message>
        <source>follows the paint, %1 to %2 µs</source>
        <translation>folgt dem Lack, %1 bis %2 µs</translation>
    </message>
    <message>
        <source>paint %1: %2</source>
        <translation>Lack %1: %2</translation>
    </message>
    <message>
        <source>As the sensor stands.</source>
        <translation>Wie der Sensor eingestellt ist.</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>Licht</translation>
    </message>
    <message>
        <source>Find light</source>
        <translation>Licht suchen</translation>
    </message>
    <message>
        <source>The robot stands at the spot; exposure and gain are found from the stripe</source>
        <translation>Der Roboter steht an der Messstelle; Belichtung und Verstärkung werden am Streifen gefunden</translation>
    </message>
    <message>
        <source>As the sensor</source>
        <translation>Wie der Sensor</translation>
    </message>
    <message>
        <source>The spot sets nothing of its own any more; undo brings it back</source>
        <translation>Die Messstelle stellt nichts Eigenes mehr ein; Rückgängig bringt es zurück</translation>
    </message>
    <message>
        <source>light</source>
        <translation>Licht</translation>
    </message>
    <message>
        <source>Too dark even at %1 µs: open the aperture, or stand still at the trigger.</source>
        <translation>Auch mit %1 µs zu dunkel: Blende öffnen oder am Trigger stehen bleiben.</translation>
    </message>
    <message>
        <source>Too bright even at the shortest exposure: close the aperture.</source>
        <translation>Auch mit der kürzesten Belichtung zu hell: Blende schließen.</translation>
    </message>
    <message>
        <source>%1 % of the lines stay dark; where the robot stands still, several exposures are merged.</source>
        <translation>%1 % der Zeilen bleiben dunkel; wo der Roboter stehen bleibt, werden mehrere Belichtungen zusammengeführt.</translation>
    </message>
    <message>
        <source>No stripe was seen (frames: %1): is the laser on, the part there?</source>
        <translation>Kein Streifen zu sehen (Bilder: %1): ist der Laser an, das Teil da?</translation>
    </message>
    <message>
        <source>Found (frames: %1).</source>
        <translation>Gefunden (Bilder: %1).</translation>
    </message>
</context>
<context>
    <name>seamwright::SpotTree</name>
    <message>
        <source>Spots and regions</source>
        <translation>Messstellen und Korrekturbereiche</translation>
    </message>
    <message>
        <source>Spots in the order of measuring, and regions with their spots</source>
        <translation>Messstellen in der Reihenfolge des Messens, und Korrekturbereiche mit ihren Messstellen</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>disabled</source>
        <translation>ausgeschaltet</translation>
    </message>
    <message>
        <source>no reference</source>
        <translation>keine Referenz</translation>
    </message>
    <message>
        <source>Spots (%1)</source>
        <translation>Messstellen (%1)</translation>
    </message>
    <message>
        <source>Regions (%1)</source>
        <translation>Korrekturbereiche (%1)</translation>
    </message>
    <message numerus="yes">
        <source>%n spot(s)</source>
        <translation>
            <numerusform>%n Messstelle</numerusform>
            <numerusform>%n Messstellen</numerusform>
        </translation>
    </message>
    <message>
        <source>from the drawing</source>
        <translation>aus der Zeichnung</translation>
    </message>
    <message>
        <source>of another part type</source>
        <translation>von anderem Teiletyp</translation>
    </message>
    <message>
        <source>taught, pass open</source>
        <translation>eingelernt, Durchfahrt offen</translation>
    </message>
    <message>
        <source>taught, pass accepted</source>
        <translation>eingelernt, Durchfahrt angenommen</translation>
    </message>
</context>
<context>
    <name>seamwright::StationWorker</name>
    <message>
        <source>The robot was not moved: cancelled.</source>
        <translation>Der Roboter wurde nicht gefahren: abgebrochen.</translation>
    </message>
    <message>
        <source>Moving the robot</source>
        <translation>Roboter wird gefahren</translation>
    </message>
    <message>
        <source>Recording</source>
        <translation>Aufzeichnung</translation>
    </message>
    <message>
        <source>Along the gap</source>
        <translation>Den Spalt entlang</translation>
    </message>
    <message>
        <source>The gap was not measured.</source>
        <translation>Der Spalt wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>Reading the recording</source>
        <translation>Aufzeichnung wird gelesen</translation>
    </message>
    <message>
        <source>Connecting</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <source>Disconnecting</source>
        <translation>Trennen</translation>
    </message>
    <message>
        <source>Measuring</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Zero shift</source>
        <translation>Nullverschiebung</translation>
    </message>
    <message>
        <source>Teaching</source>
        <translation>Einlernen</translation>
    </message>
    <message>
        <source>Recording the pass</source>
        <translation>Durchfahrt aufzeichnen</translation>
    </message>
    <message>
        <source>Setting the sensor</source>
        <translation>Den Sensor einstellen</translation>
    </message>
    <message>
        <source>sensor %1 is not connected</source>
        <translation>Sensor %1 ist nicht verbunden</translation>
    </message>
    <message>
        <source>Capturing</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Known shift</source>
        <translation>Bekannte Verschiebung</translation>
    </message>
    <message>
        <source>The devices were not connected.</source>
        <translation>Die Geräte wurden nicht verbunden.</translation>
    </message>
    <message>
        <source>The part was not measured.</source>
        <translation>Das Teil wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>The zero shift was not measured.</source>
        <translation>Die Nullverschiebung wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>The known shift was not measured.</source>
        <translation>Die bekannte Verschiebung wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>The reference was not measured.</source>
        <translation>Die Referenz wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>The pass was not recorded.</source>
        <translation>Die Durchfahrt wurde nicht aufgezeichnet.</translation>
    </message>
    <message>
        <source>The pass cannot be judged.</source>
        <translation>Die Durchfahrt lässt sich nicht beurteilen.</translation>
    </message>
    <message>
        <source>The robot was not moved.</source>
        <translation>Der Roboter wurde nicht gefahren.</translation>
    </message>
    <message>
        <source>The sensor did not take the setting.</source>
        <translation>Der Sensor nahm die Einstellung nicht an.</translation>
    </message>
    <message>
        <source>Study</source>
        <translation>Untersuchung</translation>
    </message>
    <message>
        <source>The part was not put in.</source>
        <translation>Das Teil wurde nicht eingelegt.</translation>
    </message>
    <message>
        <source>The study was not measured.</source>
        <translation>Die Untersuchung wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>Robot&apos;s repeatability</source>
        <translation>Wiederholgenauigkeit des Roboters</translation>
    </message>
    <message>
        <source>The robot was not measured.</source>
        <translation>Der Roboter wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>Latency and jitter of the trigger</source>
        <translation>Latenz und Jitter des Triggers</translation>
    </message>
    <message>
        <source>The trigger was not measured.</source>
        <translation>Der Trigger wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>Searching cameras</source>
        <translation>Kameras werden gesucht</translation>
    </message>
    <message>
        <source>The robot is not connected.</source>
        <translation>Der Roboter ist nicht verbunden.</translation>
    </message>
    <message>
        <source>The robot does not tell where it stands.</source>
        <translation>Der Roboter sagt nicht, wo er steht.</translation>
    </message>
    <message>
        <source>Confirming</source>
        <translation>Bestätigen</translation>
    </message>
    <message>
        <source>The spot was not confirmed.</source>
        <translation>Die Messstelle wurde nicht bestätigt.</translation>
    </message>
    <message>
        <source>Finding the light</source>
        <translation>Licht wird gesucht</translation>
    </message>
    <message>
        <source>The light was not found.</source>
        <translation>Das Licht wurde nicht gefunden.</translation>
    </message>
    <message>
        <source>Servoing the panel</source>
        <translation>Servoing des Anbauteils</translation>
    </message>
    <message>
        <source>Fitting the panel</source>
        <translation>Einpassen des Anbauteils</translation>
    </message>
    <message>
        <source>Measuring the panel</source>
        <translation>Messen des Anbauteils</translation>
    </message>
    <message>
        <source>The panel was not measured.</source>
        <translation>Das Anbauteil wurde nicht gemessen.</translation>
    </message>
    <message>
        <source>Learning the sensitivity</source>
        <translation>Lernen der Empfindlichkeit</translation>
    </message>
    <message>
        <source>The sensitivity was not learnt.</source>
        <translation>Die Empfindlichkeit wurde nicht gelernt.</translation>
    </message>
    <message>
        <source>Teaching the panel</source>
        <translation>Einlernen des Anbauteils</translation>
    </message>
    <message>
        <source>The panel was not taught.</source>
        <translation>Das Anbauteil wurde nicht eingelernt.</translation>
    </message>
    <message>
        <source>&quot;%1&quot; was not begun.</source>
        <translation>„%1“ wurde nicht begonnen.</translation>
    </message>
</context>
<context>
    <name>seamwright::StepPage</name>
    <message>
        <source>%1: %2</source>
        <translation>%1: %2</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>Fortschritt</translation>
    </message>
    <message>
        <source>How far the measuring is</source>
        <translation>Wie weit das Messen ist</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Stop the measuring; nothing is pushed</source>
        <translation>Das Messen abbrechen; nichts wird übertragen</translation>
    </message>
    <message>
        <source>run %1</source>
        <translation>Lauf %1</translation>
    </message>
    <message>
        <source>zero shift %1</source>
        <translation>Nullverschiebung %1</translation>
    </message>
    <message>
        <source>known shift %1</source>
        <translation>bekannte Verschiebung %1</translation>
    </message>
    <message>
        <source>and</source>
        <translation>und</translation>
    </message>
    <message>
        <source>No project is open: open one or make a new one (menu File).</source>
        <translation>Es ist kein Projekt offen: eines öffnen oder ein neues anlegen (Menü Datei).</translation>
    </message>
    <message>
        <source>A value is refused: mend it, or press Esc in its field.</source>
        <translation>Ein Wert wurde abgelehnt: berichtigen, oder in seinem Feld Esc drücken.</translation>
    </message>
</context>
<context>
    <name>seamwright::StepRail</name>
    <message>
        <source>%1 %2</source>
        <translation>%1 %2</translation>
    </message>
    <message>
        <source>next, stale</source>
        <translation>als Nächstes, veraltet</translation>
    </message>
    <message>
        <source>%1: %2. %3</source>
        <translation>%1: %2. %3</translation>
    </message>
</context>
<context>
    <name>seamwright::Studio</name>
    <message>
        <source>Restore unsaved edits?</source>
        <translation>Nicht gespeicherte Änderungen wiederherstellen?</translation>
    </message>
    <message>
        <source>The last session ended without saving. Its edits of %1 are still there:</source>
        <translation>Die letzte Sitzung endete ohne Speichern. Ihre Änderungen vom %1 sind noch da:</translation>
    </message>
    <message>
        <source>
and %1 more</source>
        <translation>
und %1 weitere</translation>
    </message>
    <message>
        <source>Restore</source>
        <translation>Wiederherstellen</translation>
    </message>
    <message>
        <source>Open as saved</source>
        <translation>Öffnen wie gespeichert</translation>
    </message>
    <message>
        <source>The edits come back; save keeps them</source>
        <translation>Die Änderungen kommen zurück; Speichern behält sie</translation>
    </message>
    <message>
        <source>The edits are thrown away</source>
        <translation>Die Änderungen werden verworfen</translation>
    </message>
    <message>
        <source>The project was not opened.</source>
        <translation>Das Projekt wurde nicht geöffnet.</translation>
    </message>
    <message>
        <source>The project was not made.</source>
        <translation>Das Projekt wurde nicht angelegt.</translation>
    </message>
</context>
<context>
    <name>seamwright::TargetView</name>
    <message>
        <source>Live picture with the target</source>
        <translation>Livebild mit dem Ziel</translation>
    </message>
    <message>
        <source>What the sensor sees of the target; the outline is what would be captured</source>
        <translation>Was der Sensor vom Ziel sieht; der Umriss ist, was aufgenommen würde</translation>
    </message>
</context>
<context>
    <name>seamwright::TeachPage</name>
    <message>
        <source>Moves the robot straight to the spot: look whether the way is free</source>
        <translation>Fährt den Roboter geradewegs zur Messstelle: nachsehen, ob der Weg frei ist</translation>
    </message>
    <message>
        <source>Jog the sensor over the contour, take the pose, point at the feature, measure its reference.</source>
        <translation>Den Sensor über die Kontur fahren, die Pose nehmen, auf das Merkmal zeigen, seine Referenz messen.</translation>
    </message>
    <message>
        <source>Duplicate</source>
        <translation>Duplizieren</translation>
    </message>
    <message>
        <source>The same spot once more</source>
        <translation>Dieselbe Messstelle noch einmal</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Another name for the spot</source>
        <translation>Ein anderer Name für die Messstelle</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>Nach oben</translation>
    </message>
    <message>
        <source>Measure it one earlier</source>
        <translation>Eine Stelle früher messen</translation>
    </message>
    <message>
        <source>Down</source>
        <translation>Nach unten</translation>
    </message>
    <message>
        <source>Measure it one later</source>
        <translation>Eine Stelle später messen</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Take the spot out; undo brings it back</source>
        <translation>Die Messstelle herausnehmen; Rückgängig bringt sie zurück</translation>
    </message>
    <message>
        <source>Add spot</source>
        <translation>Messstelle hinzufügen</translation>
    </message>
    <message>
        <source>A new spot at the robot&apos;s present pose</source>
        <translation>Eine neue Messstelle an der jetzigen Pose des Roboters</translation>
    </message>
    <message>
        <source>Enabled</source>
        <translation>Eingeschaltet</translation>
    </message>
    <message>
        <source>A disabled spot is not measured</source>
        <translation>Eine ausgeschaltete Messstelle wird nicht gemessen</translation>
    </message>
    <message>
        <source>Required</source>
        <translation>Notwendig</translation>
    </message>
    <message>
        <source>Nothing is pushed when a required spot was not measured</source>
        <translation>Nichts wird übertragen, wenn eine notwendige Messstelle nicht gemessen wurde</translation>
    </message>
    <message>
        <source>required</source>
        <translation>notwendig</translation>
    </message>
    <message>
        <source>Pose of the flange at the trigger</source>
        <translation>Pose des Flanschs am Trigger</translation>
    </message>
    <message>
        <source>base_from_flange, in the notation of the robot&apos;s brand; paste a whole pose into any field</source>
        <translation>base_from_flange, in der Schreibweise der Robotermarke; eine ganze Pose in ein beliebiges Feld einfügen</translation>
    </message>
    <message>
        <source>pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <source>Take from the robot</source>
        <translation>Vom Roboter nehmen</translation>
    </message>
    <message>
        <source>The pose where the robot stands now</source>
        <translation>Die Pose, in der der Roboter jetzt steht</translation>
    </message>
    <message>
        <source>Go there</source>
        <translation>Dorthin fahren</translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>The sensor that looks at the spot</source>
        <translation>Der Sensor, der die Messstelle sieht</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>The robot that carries the sensor</source>
        <translation>Der Roboter, der den Sensor trägt</translation>
    </message>
    <message>
        <source>sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <source>robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>Feature of the contour</source>
        <translation>Merkmal der Kontur</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>Which point of the contour is measured</source>
        <translation>Welcher Punkt der Kontur gemessen wird</translation>
    </message>
    <message>
        <source>Point at it</source>
        <translation>Darauf zeigen</translation>
    </message>
    <message>
        <source>Click the contour in the live profile, where the feature is</source>
        <translation>Im laufenden Profil auf die Kontur klicken, wo das Merkmal ist</translation>
    </message>
    <message>
        <source>Drag template</source>
        <translation>Vorlage ziehen</translation>
    </message>
    <message>
        <source>Drag a window in the live profile: the contour inside becomes the template</source>
        <translation>Im laufenden Profil ein Fenster ziehen: die Kontur darin wird zur Vorlage</translation>
    </message>
    <message>
        <source>Reference by click</source>
        <translation>Referenz durch Klick</translation>
    </message>
    <message>
        <source>Reference</source>
        <translation>Referenz</translation>
    </message>
    <message>
        <source>Repeats</source>
        <translation>Wiederholungen</translation>
    </message>
    <message>
        <source>How often the reference is measured</source>
        <translation>Wie oft die Referenz gemessen wird</translation>
    </message>
    <message>
        <source>Measure reference</source>
        <translation>Referenz messen</translation>
    </message>
    <message>
        <source>The robot stands still at the spot and measures; mean and spread are shown</source>
        <translation>Der Roboter steht an der Messstelle still und misst; Mittel und Streuung werden gezeigt</translation>
    </message>
    <message>
        <source>Pass, weights and noise</source>
        <translation>Durchfahrt, Gewichte und Rauschen</translation>
    </message>
    <message>
        <source>reference point</source>
        <translation>Referenzpunkt</translation>
    </message>
    <message>
        <source>reference</source>
        <translation>Referenz</translation>
    </message>
    <message>
        <source>Spread of %1 measurements: x %2 mm, z %3 mm (1 sigma); %4 left out</source>
        <translation>Streuung von %1 Messungen: x %2 mm, z %3 mm (1 Sigma); %4 ausgelassen</translation>
    </message>
    <message>
        <source>Not measured yet.</source>
        <translation>Noch nicht gemessen.</translation>
    </message>
    <message>
        <source>x %1   z %2 mm in the sensor; %3 points of contour kept</source>
        <translation>x %1   z %2 mm im Sensor; %3 Konturpunkte behalten</translation>
    </message>
    <message>
        <source>Rename spot</source>
        <translation>Messstelle umbenennen</translation>
    </message>
    <message>
        <source>feature</source>
        <translation>Merkmal</translation>
    </message>
    <message>
        <source>template</source>
        <translation>Vorlage</translation>
    </message>
    <message>
        <source>Via points</source>
        <translation>Zwischenpunkte</translation>
    </message>
    <message>
        <source>Passed in this order on the way from the spot before. Write the robot&apos;s program anew after a change.</source>
        <translation>Auf dem Weg von der vorigen Messstelle in dieser Reihenfolge überfahren. Nach einer Änderung das Roboterprogramm neu schreiben.</translation>
    </message>
    <message>
        <source>Add here</source>
        <translation>Hier einfügen</translation>
    </message>
    <message>
        <source>The pose where the robot stands now, behind the selected via point</source>
        <translation>Die Pose, in der der Roboter gerade steht, hinter dem gewählten Zwischenpunkt</translation>
    </message>
    <message>
        <source>Remove point</source>
        <translation>Punkt entfernen</translation>
    </message>
    <message>
        <source>Take the selected via point out; undo brings it back</source>
        <translation>Den gewählten Zwischenpunkt herausnehmen; Rückgängig holt ihn zurück</translation>
    </message>
    <message>
        <source>via points</source>
        <translation>Zwischenpunkte</translation>
    </message>
    <message>
        <source>Stand still at the trigger</source>
        <translation>Am Trigger stehen bleiben</translation>
    </message>
    <message>
        <source>The robot stops, measures and goes on: no trigger jitter, but it costs time. Write the robot&apos;s program anew after a change.</source>
        <translation>Der Roboter hält, misst und fährt weiter: kein Triggerjitter, aber es kostet Zeit. Nach einer Änderung das Roboterprogramm neu schreiben.</translation>
    </message>
    <message>
        <source>stand still at the trigger</source>
        <translation>am Trigger stehen bleiben</translation>
    </message>
    <message>
        <source>Jog</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Move the robot by hand (F8)</source>
        <translation>Roboter von Hand bewegen (F8)</translation>
    </message>
    <message>
        <source>Confirm</source>
        <translation>Bestätigen</translation>
    </message>
    <message>
        <source>The robot measures the spot from the drawing on the part; where it is plausible, what was measured becomes its reference</source>
        <translation>Der Roboter misst die Messstelle aus der Zeichnung am Teil; ist es plausibel, wird das Gemessene ihre Referenz</translation>
    </message>
    <message>
        <source>confirmed on the part</source>
        <translation>am Teil bestätigt</translation>
    </message>
    <message>
        <source>Shift against the drawing: x %1 mm, z %2 mm</source>
        <translation>Verschiebung gegen die Zeichnung: x %1 mm, z %2 mm</translation>
    </message>
    <message>
        <source>x %1   z %2 mm in the sensor, from drawing %3, not confirmed</source>
        <translation>x %1   z %2 mm im Sensor, aus der Zeichnung %3, nicht bestätigt</translation>
    </message>
    <message>
        <source>Another part type&apos;s: measure it on a part of this type.</source>
        <translation>Von einem anderen Teiletyp: an einem Teil dieses Typs messen.</translation>
    </message>
    <message>
        <source>Click the template&apos;s reference point in the live profile; it need not lie on the contour. Measure the reference anew then.</source>
        <translation>Im laufenden Profil den Referenzpunkt der Vorlage anklicken; er muss nicht auf der Kontur liegen. Danach die Referenz neu messen.</translation>
    </message>
</context>
<context>
    <name>seamwright::TrendChart</name>
    <message>
        <source>lower limit</source>
        <translation>untere Grenze</translation>
    </message>
    <message>
        <source>upper limit</source>
        <translation>obere Grenze</translation>
    </message>
    <message>
        <source>no parts yet</source>
        <translation>noch keine Teile</translation>
    </message>
    <message numerus="yes">
        <source>%n beyond limits</source>
        <translation>
            <numerusform>%n außerhalb der Grenzen</numerusform>
            <numerusform>%n außerhalb der Grenzen</numerusform>
        </translation>
    </message>
    <message>
        <source>History over parts</source>
        <translation>Verlauf über Teile</translation>
    </message>
    <message>
        <source>One mark per part. A click opens the part; Left and Right move, Enter opens.</source>
        <translation>Eine Marke je Teil. Ein Klick öffnet das Teil; Links und Rechts bewegen, Enter öffnet.</translation>
    </message>
    <message>
        <source>Chart title</source>
        <translation>Titel des Diagramms</translation>
    </message>
    <message>
        <source>History chart</source>
        <translation>Verlaufsdiagramm</translation>
    </message>
    <message numerus="yes">
        <source>%n without a value, the others within limits</source>
        <translation>
            <numerusform>%n ohne Wert, die anderen innerhalb der Grenzen</numerusform>
            <numerusform>%n ohne Wert, die anderen innerhalb der Grenzen</numerusform>
        </translation>
    </message>
    <message>
        <source>all values within limits</source>
        <translation>alle Werte innerhalb der Grenzen</translation>
    </message>
</context>
<context>
    <name>seamwright::TypeChooser</name>
    <message>
        <source>Part type</source>
        <translation>Teiletyp</translation>
    </message>
    <message>
        <source>Whose spots are measured and whose regions are pushed; those of the other types stay</source>
        <translation>Wessen Messstellen gemessen und wessen Korrekturbereiche übertragen werden; die der anderen Typen bleiben</translation>
    </message>
</context>
<context>
    <name>seamwright::ViewFeeder</name>
    <message>
        <source>sensor %1   %2 /s   %3 dropped</source>
        <translation>Sensor %1   %2 /s   %3 verloren</translation>
    </message>
    <message>
        <source>Sensor %1 cannot be told to send a part of its image.</source>
        <translation>Sensor %1 kann keinen Ausschnitt seines Bilds senden.</translation>
    </message>
    <message>
        <source>sensor %1   no frame since %2 s</source>
        <translation>Sensor %1   kein Bild seit %2 s</translation>
    </message>
    <message>
        <source>sensor %1   no frame yet</source>
        <translation>Sensor %1   noch kein Bild</translation>
    </message>
    <message>
        <source>sensor %1   measures, no live picture</source>
        <translation>Sensor %1   misst, kein laufendes Bild</translation>
    </message>
    <message>
        <source>sensor %1   not connected</source>
        <translation>Sensor %1   nicht verbunden</translation>
    </message>
</context>
<context>
    <name>seamwright::SignInDialog</name>
    <message>
        <source>service</source>
        <translation>Dienst</translation>
    </message>
    <message>
        <source>operator</source>
        <translation>Bediener</translation>
    </message>
    <message>
        <source>engineer</source>
        <translation>Techniker</translation>
    </message>
    <message>
        <source>administrator</source>
        <translation>Administrator</translation>
    </message>
    <message>
        <source>Sign in</source>
        <translation>Anmelden</translation>
    </message>
    <message>
        <source>The project has users: to teach, to change limits and to push somebody signs in. To look at it and to measure nobody has to.</source>
        <translation>Das Projekt hat Benutzer: zum Einlernen, zum Ändern von Grenzen und zum Übertragen meldet sich jemand an. Zum Ansehen und zum Messen muss es niemand.</translation>
    </message>
    <message>
        <source>User</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>Who works</source>
        <translation>Wer arbeitet</translation>
    </message>
    <message>
        <source>Password</source>
        <translation>Passwort</translation>
    </message>
    <message>
        <source>After three wrong ones it takes a while until the next is looked at</source>
        <translation>Nach drei falschen dauert es eine Weile, bis das nächste angesehen wird</translation>
    </message>
    <message>
        <source>Takes a moment</source>
        <translation>Dauert einen Augenblick</translation>
    </message>
    <message>
        <source>Only look</source>
        <translation>Nur ansehen</translation>
    </message>
    <message>
        <source>Nobody signs in</source>
        <translation>Niemand meldet sich an</translation>
    </message>
</context>
<context>
    <name>seamwright::PathDialog</name>
    <message>
        <source>Path corrected by a run</source>
        <translation>Von einem Lauf korrigierte Bahn</translation>
    </message>
    <message>
        <source>Taught path</source>
        <translation>Eingelernte Bahn</translation>
    </message>
    <message>
        <source>A table or a robot program</source>
        <translation>Eine Tabelle oder ein Roboterprogramm</translation>
    </message>
    <message>
        <source>Choose the path...</source>
        <translation>Bahn wählen...</translation>
    </message>
    <message>
        <source>A table (.csv) or a robot program: KRL, RAPID, FANUC, URScript, APT</source>
        <translation>Eine Tabelle (.csv) oder ein Roboterprogramm: KRL, RAPID, FANUC, URScript, APT</translation>
    </message>
    <message>
        <source>Written as</source>
        <translation>Geschrieben als</translation>
    </message>
    <message>
        <source>In whose notation a table&apos;s poses are</source>
        <translation>In wessen Schreibweise die Posen einer Tabelle stehen</translation>
    </message>
    <message>
        <source>the robot&apos;s base</source>
        <translation>der Roboterbasis</translation>
    </message>
    <message>
        <source>the work object</source>
        <translation>dem Werkobjekt</translation>
    </message>
    <message>
        <source>Points are in</source>
        <translation>Punkte stehen in</translation>
    </message>
    <message>
        <source>Of a program: its own frame is the work object</source>
        <translation>Bei einem Programm: sein eigenes Koordinatensystem ist das Werkobjekt</translation>
    </message>
    <message>
        <source>Corrected by</source>
        <translation>Korrigiert von</translation>
    </message>
    <message>
        <source>The run whose displacements move the path</source>
        <translation>Der Lauf, dessen Verschiebungen die Bahn bewegen</translation>
    </message>
    <message>
        <source>The path goes on from its last point to its first</source>
        <translation>Die Bahn geht vom letzten Punkt zum ersten weiter</translation>
    </message>
    <message>
        <source>A closed bead</source>
        <translation>Eine geschlossene Raupe</translation>
    </message>
    <message>
        <source>Without the lines that are not understood</source>
        <translation>Ohne die Zeilen, die nicht verstanden werden</translation>
    </message>
    <message>
        <source>Of a program; the path then has gaps there</source>
        <translation>Bei einem Programm; die Bahn hat dort dann Lücken</translation>
    </message>
    <message>
        <source>Region</source>
        <translation>Korrekturbereich</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>In transitions</source>
        <translation>In Übergängen</translation>
    </message>
    <message>
        <source>Refused because</source>
        <translation>Verweigert, weil</translation>
    </message>
    <message>
        <source>What each region does to the path</source>
        <translation>Was jeder Korrekturbereich mit der Bahn macht</translation>
    </message>
    <message>
        <source>Program for</source>
        <translation>Programm für</translation>
    </message>
    <message>
        <source>The robot that runs it</source>
        <translation>Der Roboter, der es fährt</translation>
    </message>
    <message>
        <source> mm/s</source>
        <translation> mm/s</translation>
    </message>
    <message>
        <source>Speed</source>
        <translation>Geschwindigkeit</translation>
    </message>
    <message>
        <source>Of the program</source>
        <translation>Des Programms</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>Of files and program</source>
        <translation>Von Dateien und Programm</translation>
    </message>
    <message>
        <source>Write the program...</source>
        <translation>Programm schreiben...</translation>
    </message>
    <message>
        <source>Asks for a folder; nothing is sent to the robot</source>
        <translation>Fragt nach einem Ordner; an den Roboter wird nichts gesendet</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>The path leaves the scene</source>
        <translation>Die Bahn verschwindet aus der Szene</translation>
    </message>
    <message>
        <source>run %1: %2, %3</source>
        <translation>Lauf %1: %2, %3</translation>
    </message>
    <message>
        <source>Choose the path as it was taught.</source>
        <translation>Die Bahn wählen, wie sie eingelernt wurde.</translation>
    </message>
    <message>
        <source>There is no run yet: measure a part first.</source>
        <translation>Es gibt noch keinen Lauf: zuerst ein Teil messen.</translation>
    </message>
    <message>
        <source>%1 points on %2 mm, moved by up to %3 mm, 3 sigma at most %4 mm</source>
        <translation>%1 Punkte auf %2 mm, um bis zu %3 mm verschoben, 3 Sigma höchstens %4 mm</translation>
    </message>
    <message>
        <source>Refused, nothing is written: %1</source>
        <translation>Verweigert, es wird nichts geschrieben: %1</translation>
    </message>
    <message>
        <source>Paths (*.csv *.src *.mod *.sys *.prg *.ls *.script *.urscript *.apt *.cl *.cls);;All files (*)</source>
        <translation>Bahnen (*.csv *.src *.mod *.sys *.prg *.ls *.script *.urscript *.apt *.cl *.cls);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Folder of the program</source>
        <translation>Ordner des Programms</translation>
    </message>
    <message>
        <source>The program was not written.</source>
        <translation>Das Programm wurde nicht geschrieben.</translation>
    </message>
    <message>
        <source>%1 written to %2</source>
        <translation>%1 nach %2 geschrieben</translation>
    </message>
</context>
<context>
    <name>seamwright::ProgramDialog</name>
    <message>
        <source>Program for the robot&apos;s controller</source>
        <translation>Programm für die Robotersteuerung</translation>
    </message>
    <message>
        <source>The module that talks to Seamwright, the measuring program with entry, trigger and exit of every spot, and the application&apos;s frames. Drive it slowly once before it runs by itself.</source>
        <translation>Das Modul, das mit Seamwright spricht, das Messprogramm mit Einfahrt, Auslösung und Ausfahrt jeder Messstelle und die Frames der Anwendung. Einmal langsam abfahren, bevor es allein läuft.</translation>
    </message>
    <message>
        <source>Robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>Whose program it is</source>
        <translation>Wessen Programm es ist</translation>
    </message>
    <message>
        <source>Part type</source>
        <translation>Teiletyp</translation>
    </message>
    <message>
        <source>Its spots; the program says the type with its start signal</source>
        <translation>Seine Messstellen; das Programm nennt den Typ mit seinem Startsignal</translation>
    </message>
    <message>
        <source>Controller</source>
        <translation>Steuerung</translation>
    </message>
    <message>
        <source>For which controller the files are</source>
        <translation>Für welche Steuerung die Dateien sind</translation>
    </message>
    <message>
        <source>Spot</source>
        <translation>Messstelle</translation>
    </message>
    <message>
        <source>Via points</source>
        <translation>Zwischenpunkte</translation>
    </message>
    <message>
        <source>Speed, mm/s</source>
        <translation>Geschwindigkeit, mm/s</translation>
    </message>
    <message>
        <source>In the order of measuring</source>
        <translation>In der Reihenfolge des Messens</translation>
    </message>
    <message>
        <source>Write the files...</source>
        <translation>Dateien schreiben...</translation>
    </message>
    <message>
        <source>Asks for a folder; nothing is sent to the robot</source>
        <translation>Fragt nach einem Ordner; an den Roboter wird nichts gesendet</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Nothing more is written</source>
        <translation>Es wird nichts mehr geschrieben</translation>
    </message>
    <message>
        <source>%1 spots, %2 frames: %3</source>
        <translation>%1 Messstellen, %2 Frames: %3</translation>
    </message>
    <message>
        <source>Folder of the program</source>
        <translation>Ordner des Programms</translation>
    </message>
    <message>
        <source>The program was not written.</source>
        <translation>Das Programm wurde nicht geschrieben.</translation>
    </message>
    <message>
        <source>%1 files written to %2</source>
        <translation>%1 Dateien nach %2 geschrieben</translation>
    </message>
    <message>
        <source>The files of part type %1 have the same names: a controller holds the program of one type, the one that was loaded last, and parts of the others are refused at their start. Write each type into a folder of its own, and load the one that comes.</source>
        <translation>Die Dateien des Teiletyps %1 heißen ebenso: Eine Steuerung hält das Programm eines Typs, das zuletzt geladene, und Teile der anderen werden beim Start abgewiesen. Jeden Typ in einen eigenen Ordner schreiben und den laden, der kommt.</translation>
    </message>
</context>
<context>
    <name>seamwright::GapDialog</name>
    <message>
        <source>Gap along a path</source>
        <translation>Spalt entlang einer Bahn</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>Along the spots</source>
        <translation>Entlang der Messstellen</translation>
    </message>
    <message>
        <source>In this order, straight from one to the next: S1, S2, S3</source>
        <translation>In dieser Reihenfolge, gerade von einer zur nächsten: S1, S2, S3</translation>
    </message>
    <message>
        <source>Step</source>
        <translation>Schritt</translation>
    </message>
    <message>
        <source>Of the sensor&apos;s travel between two profiles</source>
        <translation>Weg des Sensors zwischen zwei Profilen</translation>
    </message>
    <message>
        <source>Drive along the gap...</source>
        <translation>Den Spalt abfahren...</translation>
    </message>
    <message>
        <source>The robot stops at every step; asks before it moves</source>
        <translation>Der Roboter hält bei jedem Schritt; fragt, bevor er fährt</translation>
    </message>
    <message>
        <source>From a recording...</source>
        <translation>Aus einer Aufzeichnung...</translation>
    </message>
    <message>
        <source>A capture that was recorded while the robot travelled</source>
        <translation>Eine Aufzeichnung von der Fahrt des Roboters</translation>
    </message>
    <message>
        <source>Nozzle</source>
        <translation>Düse</translation>
    </message>
    <message>
        <source>Its width where it enters the gap</source>
        <translation>Ihre Breite, wo sie in den Spalt taucht</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Freiraum</translation>
    </message>
    <message>
        <source>What must be left on either side</source>
        <translation>Was auf jeder Seite bleiben muss</translation>
    </message>
    <message>
        <source>left</source>
        <translation>links</translation>
    </message>
    <message>
        <source>right</source>
        <translation>rechts</translation>
    </message>
    <message>
        <source>Flush against the part on the</source>
        <translation>Bündigkeit zum Teil</translation>
    </message>
    <message>
        <source>Whose surface is the reference</source>
        <translation>Wessen Oberfläche die Referenz ist</translation>
    </message>
    <message>
        <source>Where</source>
        <translation>Wo</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>From, mm</source>
        <translation>Von, mm</translation>
    </message>
    <message>
        <source>To, mm</source>
        <translation>Bis, mm</translation>
    </message>
    <message>
        <source>Narrowest, mm</source>
        <translation>Engste, mm</translation>
    </message>
    <message>
        <source>Where the nozzle does not pass</source>
        <translation>Wo die Düse nicht durchkommt</translation>
    </message>
    <message>
        <source>Write...</source>
        <translation>Schreiben...</translation>
    </message>
    <message>
        <source>The report (.html) or every point as a table (.csv)</source>
        <translation>Den Bericht (.html) oder jeden Punkt als Tabelle (.csv)</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Nothing is kept</source>
        <translation>Nichts wird behalten</translation>
    </message>
    <message>
        <source>%1 of %2 profiles</source>
        <translation>%1 von %2 Profilen</translation>
    </message>
    <message>
        <source>The robot now drives along %1. Is its way free?</source>
        <translation>Der Roboter fährt jetzt %1 ab. Ist sein Weg frei?</translation>
    </message>
    <message>
        <source>Recording</source>
        <translation>Aufzeichnung</translation>
    </message>
    <message>
        <source>Recordings (*.seam);;All files (*)</source>
        <translation>Aufzeichnungen (*.seam);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Drive along the gap, or choose a recording.</source>
        <translation>Den Spalt abfahren oder eine Aufzeichnung wählen.</translation>
    </message>
    <message>
        <source>None of %1 profiles shows the gap.</source>
        <translation>Keines von %1 Profilen zeigt den Spalt.</translation>
    </message>
    <message>
        <source>%1 of %2 profiles measured along %3 mm; gap %4 to %5 mm, needed %6 mm with 3 sigma</source>
        <translation>%1 von %2 Profilen gemessen auf %3 mm; Spalt %4 bis %5 mm, nötig %6 mm mit 3 Sigma</translation>
    </message>
    <message>
        <source>The nozzle passes. %1</source>
        <translation>Die Düse kommt durch. %1</translation>
    </message>
    <message>
        <source>The nozzle does not pass everywhere. %1</source>
        <translation>Die Düse kommt nicht überall durch. %1</translation>
    </message>
    <message>
        <source>Report (*.html);;Points (*.csv)</source>
        <translation>Bericht (*.html);;Punkte (*.csv)</translation>
    </message>
    <message>
        <source>The file was not written.</source>
        <translation>Die Datei wurde nicht geschrieben.</translation>
    </message>
    <message>
        <source>Written to %1</source>
        <translation>Geschrieben nach %1</translation>
    </message>
    <message>
        <source>passes</source>
        <translation>kommt durch</translation>
    </message>
    <message>
        <source>doubtful</source>
        <translation>zweifelhaft</translation>
    </message>
    <message>
        <source>too narrow</source>
        <translation>zu eng</translation>
    </message>
    <message>
        <source>closed</source>
        <translation>geschlossen</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>nicht gemessen</translation>
    </message>
</context>
<context>
    <name>seamwright::GapPlot</name>
    <message>
        <source>Width of the gap over the path</source>
        <translation>Breite des Spalts über der Bahn</translation>
    </message>
    <message>
        <source>Width with 3 sigma below it; dashed: what the nozzle needs</source>
        <translation>Breite mit 3 Sigma darunter; gestrichelt: was die Düse braucht</translation>
    </message>
    <message>
        <source>path, mm</source>
        <translation>Bahn, mm</translation>
    </message>
    <message>
        <source>width, mm</source>
        <translation>Breite, mm</translation>
    </message>
    <message>
        <source>width</source>
        <translation>Breite</translation>
    </message>
    <message>
        <source>width - 3 sigma</source>
        <translation>Breite - 3 Sigma</translation>
    </message>
    <message>
        <source>does not pass</source>
        <translation>kommt nicht durch</translation>
    </message>
</context>
<context>
    <name>seamwright::RecordDialog</name>
    <message>
        <source>Record what the devices deliver</source>
        <translation>Aufzeichnen, was die Geräte liefern</translation>
    </message>
    <message>
        <source>Live profiles, teaching and runs go into the recording too, as long as it goes on. It is replayed as a sensor and a robot, and a gap or a path is judged from it later.</source>
        <translation>Auch Live-Profile, Teachen und Läufe kommen in die Aufzeichnung, solange sie läuft. Sie wird als Sensor und Roboter wieder abgespielt, und ein Spalt oder eine Bahn wird später daraus beurteilt.</translation>
    </message>
    <message>
        <source>Keep the raw images too</source>
        <translation>Auch die Rohbilder behalten</translation>
    </message>
    <message>
        <source>Of cameras: some MiB a frame; without them the profiles are kept</source>
        <translation>Von Kameras: einige MiB je Bild; ohne sie bleiben die Profile</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>Gerät</translation>
    </message>
    <message>
        <source>Frames</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>Damaged</source>
        <translation>Beschädigt</translation>
    </message>
    <message>
        <source>Lost</source>
        <translation>Verloren</translation>
    </message>
    <message>
        <source>Dropped</source>
        <translation>Verworfen</translation>
    </message>
    <message>
        <source>What is on the disk; dropped: the disk was too slow</source>
        <translation>Was auf der Platte ist; verworfen: die Platte war zu langsam</translation>
    </message>
    <message>
        <source>Record...</source>
        <translation>Aufzeichnen...</translation>
    </message>
    <message>
        <source>Asks for a file; the devices connect anew</source>
        <translation>Fragt nach einer Datei; die Geräte werden neu verbunden</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Beenden</translation>
    </message>
    <message>
        <source>Ends the recording; the devices connect anew</source>
        <translation>Beendet die Aufzeichnung; die Geräte werden neu verbunden</translation>
    </message>
    <message>
        <source>Nothing is recorded.</source>
        <translation>Es wird nichts aufgezeichnet.</translation>
    </message>
    <message>
        <source>The recording is not whole.</source>
        <translation>Die Aufzeichnung ist nicht vollständig.</translation>
    </message>
    <message>
        <source>Recorded in %1, %2 MiB</source>
        <translation>Aufgezeichnet in %1, %2 MiB</translation>
    </message>
    <message>
        <source>Recording into %1, %2 MiB</source>
        <translation>Aufzeichnung in %1, %2 MiB</translation>
    </message>
    <message>
        <source>Recording</source>
        <translation>Aufzeichnung</translation>
    </message>
    <message>
        <source>Recordings (*.seam)</source>
        <translation>Aufzeichnungen (*.seam)</translation>
    </message>
</context>
<context>
    <name>seamwright::HeadsPlot</name>
    <message>
        <source>Profiles of the chosen place</source>
        <translation>Profile des gewählten Messorts</translation>
    </message>
    <message>
        <source>Each head&apos;s profile in the place&apos;s frame; thin and dark: both as one, in which gap and flush are measured</source>
        <translation>Das Profil jedes Kopfs im Koordinatensystem des Messorts; dünn und dunkel: beide als eines, in dem Spalt und Bündigkeit gemessen werden</translation>
    </message>
    <message>
        <source>along the surface, mm</source>
        <translation>längs der Oberfläche, mm</translation>
    </message>
    <message>
        <source>across, mm</source>
        <translation>quer, mm</translation>
    </message>
    <message>
        <source>both as one</source>
        <translation>beide als eines</translation>
    </message>
</context>
<context>
    <name>seamwright::MovesPlot</name>
    <message>
        <source>What each move leaves</source>
        <translation>Was jede Bewegung übrig lässt</translation>
    </message>
    <message>
        <source>Gap and flush off the taught ones, rms over all places; 0: as the panel came; dashed: reached</source>
        <translation>Spalt und Bündigkeit gegen eingelernt, quadratisches Mittel über alle Messorte; 0: wie das Anbauteil kam; gestrichelt: erreicht</translation>
    </message>
    <message>
        <source>move</source>
        <translation>Bewegung</translation>
    </message>
    <message>
        <source>rms, mm</source>
        <translation>RMS, mm</translation>
    </message>
</context>
<context>
    <name>seamwright::PanelDialog</name>
    <message>
        <source>Take panel job %1</source>
        <translation>Greiferaufgabe %1 übernehmen</translation>
    </message>
    <message>
        <source>The panel job was not taken.</source>
        <translation>Die Greiferaufgabe wurde nicht übernommen.</translation>
    </message>
    <message>
        <source>%1 makes %2 small moves with the panel, %3 mm and %4 degrees to either side, and goes back. Is its way free?</source>
        <translation>%1 macht mit dem Anbauteil %2 kleine Bewegungen, %3 mm und %4 Grad nach jeder Seite, und kehrt zurück. Ist der Weg frei?</translation>
    </message>
    <message>
        <source>Learn with %1</source>
        <translation>Mit %1 lernen</translation>
    </message>
    <message>
        <source>%1 goes to the measuring position of %2. What is measured there becomes the taught gap and flush: the panel must be in its zero position. Is it, and is the way free?</source>
        <translation>%1 fährt in die Messposition von %2. Was dort gemessen wird, gilt als eingelernter Spalt und eingelernte Bündigkeit: Das Anbauteil muss in seiner Nulllage sein. Ist es das, und ist der Weg frei?</translation>
    </message>
    <message>
        <source>Teach %1</source>
        <translation>%1 einlernen</translation>
    </message>
    <message>
        <source>%1 now  %2
%1 new  %3</source>
        <translation>%1 jetzt  %2
%1 neu  %3</translation>
    </message>
    <message>
        <source>The first move takes %1. There are up to %2 of them, each judged by the gate.</source>
        <translation>Die erste Bewegung bringt %1. Es sind bis zu %2, jede von der Sicherheitsprüfung beurteilt.</translation>
    </message>
    <message>
        <source>This moves %1.</source>
        <translation>Das bewegt %1.</translation>
    </message>
    <message>
        <source>Nothing has been sent yet.</source>
        <translation>Noch wurde nichts gesendet.</translation>
    </message>
    <message>
        <source>Push %1 to %2</source>
        <translation>%1 an %2 übertragen</translation>
    </message>
    <message>
        <source>The panel is measured and waits for your answer below.</source>
        <translation>Das Anbauteil ist gemessen und wartet unten auf Ihre Antwort.</translation>
    </message>
    <message>
        <source>The project was changed meanwhile: measure again.</source>
        <translation>Das Projekt wurde inzwischen geändert: noch einmal messen.</translation>
    </message>
    <message>
        <source>The sensitivity cannot be inverted (condition %1): measure at more places, in other directions. Nothing was kept.</source>
        <translation>Die Empfindlichkeit lässt sich nicht umkehren (Kondition %1): an mehr Messorten und in anderen Richtungen messen. Nichts wurde behalten.</translation>
    </message>
    <message>
        <source>Learn the sensitivity of %1</source>
        <translation>Empfindlichkeit von %1 lernen</translation>
    </message>
    <message>
        <source>The sensitivity was not kept.</source>
        <translation>Die Empfindlichkeit wurde nicht behalten.</translation>
    </message>
    <message>
        <source>The sensitivity is learnt; the frame is as it was.</source>
        <translation>Die Empfindlichkeit ist gelernt; der Frame ist wie zuvor.</translation>
    </message>
    <message>
        <source>Teach panel job %1</source>
        <translation>Greiferaufgabe %1 einlernen</translation>
    </message>
    <message>
        <source>The panel was not taught.</source>
        <translation>Das Anbauteil wurde nicht eingelernt.</translation>
    </message>
    <message>
        <source>Fit a panel</source>
        <translation>Anbauteil einpassen</translation>
    </message>
    <message>
        <source>Gap and flush at each place, with one sigma; the chosen one&apos;s profiles are below</source>
        <translation>Spalt und Bündigkeit an jedem Messort, mit einem Sigma; die Profile des gewählten stehen darunter</translation>
    </message>
    <message>
        <source>Panel job</source>
        <translation>Greiferaufgabe</translation>
    </message>
    <message>
        <source>Of this project</source>
        <translation>Aus diesem Projekt</translation>
    </message>
    <message>
        <source>run number</source>
        <translation>Nummer des Laufs</translation>
    </message>
    <message>
        <source>Panel</source>
        <translation>Anbauteil</translation>
    </message>
    <message>
        <source>Its name in the runs; empty: the run&apos;s number</source>
        <translation>Sein Name in den Läufen; leer: die Nummer des Laufs</translation>
    </message>
    <message>
        <source>From a file...</source>
        <translation>Aus Datei...</translation>
    </message>
    <message>
        <source>A panel job (JSON) for this project, or measures of a panel to be fitted by themselves</source>
        <translation>Eine Greiferaufgabe (JSON) für dieses Projekt, oder Messwerte eines Anbauteils, die für sich eingepasst werden</translation>
    </message>
    <message>
        <source>Panel jobs (*.json);;All files (*)</source>
        <translation>Greiferaufgaben (*.json);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Teach...</source>
        <translation>Einlernen...</translation>
    </message>
    <message>
        <source>The panel is in its zero position: gap and flush there become the taught ones</source>
        <translation>Das Anbauteil ist in seiner Nulllage: Spalt und Bündigkeit dort gelten als eingelernt</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Nothing is written, nothing is moved by it</source>
        <translation>Nichts wird geschrieben, nichts dadurch bewegt</translation>
    </message>
    <message>
        <source>Fit in one step...</source>
        <translation>In einem Schritt einpassen...</translation>
    </message>
    <message>
        <source>Measures, asks, writes the frame through the safety gate and measures again</source>
        <translation>Misst, fragt, schreibt den Frame durch die Sicherheitsprüfung und misst noch einmal</translation>
    </message>
    <message>
        <source>Servo...</source>
        <translation>Servoing...</translation>
    </message>
    <message>
        <source>In several moves by the learnt sensitivity, each through the safety gate; asks first</source>
        <translation>In mehreren Bewegungen nach der gelernten Empfindlichkeit, jede durch die Sicherheitsprüfung; fragt vorher</translation>
    </message>
    <message>
        <source>Learn the sensitivity...</source>
        <translation>Empfindlichkeit lernen...</translation>
    </message>
    <message>
        <source>Twelve small moves through the safety gate, for servoing; asks first</source>
        <translation>Zwölf kleine Bewegungen durch die Sicherheitsprüfung, für das Servoing; fragt vorher</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Ends it after the move under way; the first frame is written back</source>
        <translation>Endet nach der laufenden Bewegung; der erste Frame wird zurückgeschrieben</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>Fortschritt</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Ends what was begun here</source>
        <translation>Beendet, was hier begonnen wurde</translation>
    </message>
    <message>
        <source>Yes</source>
        <translation>Ja</translation>
    </message>
    <message>
        <source>It is done</source>
        <translation>Es wird ausgeführt</translation>
    </message>
    <message>
        <source>No</source>
        <translation>Nein</translation>
    </message>
    <message>
        <source>Nothing is sent to the robot</source>
        <translation>Nichts wird an den Roboter gesendet</translation>
    </message>
    <message>
        <source>Gripper</source>
        <translation>Greifer</translation>
    </message>
    <message>
        <source>One step</source>
        <translation>Ein Schritt</translation>
    </message>
    <message>
        <source>± sigma</source>
        <translation>± Sigma</translation>
    </message>
    <message>
        <source>Servoing</source>
        <translation>Servoing</translation>
    </message>
    <message>
        <source>The motion in the gripper&apos;s own frame, with one sigma</source>
        <translation>Die Bewegung im eigenen Koordinatensystem des Greifers, mit einem Sigma</translation>
    </message>
    <message>
        <source>This project has no panel job: take one from a file, as an entry of &quot;panel_jobs&quot; in an exported project.</source>
        <translation>Dieses Projekt hat keine Greiferaufgabe: eine aus einer Datei übernehmen, wie ein Eintrag von „panel_jobs“ in einem ausgegebenen Projekt.</translation>
    </message>
    <message>
        <source>Connect the devices first (F4).</source>
        <translation>Zuerst die Geräte verbinden (F4).</translation>
    </message>
    <message>
        <source>Bring the panel into its zero position, then teach it.</source>
        <translation>Das Anbauteil in seine Nulllage bringen und dann einlernen.</translation>
    </message>
    <message>
        <source>Measure the panel: nothing is moved by that.</source>
        <translation>Das Anbauteil messen: Bewegt wird dadurch nichts.</translation>
    </message>
    <message>
        <source>Under way.</source>
        <translation>Läuft.</translation>
    </message>
    <message>
        <source>Measures from a file: %1. %2 Nothing is kept, nothing moves.</source>
        <translation>Messwerte aus einer Datei: %1. %2 Nichts wird behalten, nichts bewegt sich.</translation>
    </message>
    <message>
        <source>Run %1, panel %2: %3.</source>
        <translation>Lauf %1, Anbauteil %2: %3.</translation>
    </message>
    <message numerus="yes">
        <source>%n more reason(s), see the run.</source>
        <translation>
            <numerusform>%n weiterer Grund, siehe den Lauf.</numerusform>
            <numerusform>%n weitere Gründe, siehe den Lauf.</numerusform>
        </translation>
    </message>
    <message>
        <source>%1 ± %2</source>
        <translation>%1 ± %2</translation>
    </message>
    <message>
        <source>%1 / %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message>
        <source>in tolerance</source>
        <translation>in Toleranz</translation>
    </message>
    <message>
        <source>beyond tolerance</source>
        <translation>außer Toleranz</translation>
    </message>
    <message>
        <source>heads %1 mm</source>
        <translation>Köpfe %1</translation>
    </message>
    <message>
        <source>switched off</source>
        <translation>ausgeschaltet</translation>
    </message>
    <message>
        <source>not taught</source>
        <translation>nicht eingelernt</translation>
    </message>
    <message>
        <source>taught: gap %1, flush %2</source>
        <translation>eingelernt: Spalt %1, Bündigkeit %2</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Messort</translation>
    </message>
    <message>
        <source>Heads</source>
        <translation>Köpfe</translation>
    </message>
    <message>
        <source>Gap, mm</source>
        <translation>Spalt, mm</translation>
    </message>
    <message>
        <source>off taught</source>
        <translation>Abweichung</translation>
    </message>
    <message>
        <source>Flush, mm</source>
        <translation>Bündigkeit, mm</translation>
    </message>
    <message>
        <source>One step leaves, mm
gap / flush</source>
        <translation>Ein Schritt lässt, mm
Spalt / Bündigkeit</translation>
    </message>
    <message>
        <source>After it, mm
gap / flush</source>
        <translation>Danach, mm
Spalt / Bündigkeit</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>left out: contradicts the others</source>
        <translation>weggelassen: widerspricht den anderen</translation>
    </message>
    <message>
        <source>X, mm</source>
        <translation>X, mm</translation>
    </message>
    <message>
        <source>Y, mm</source>
        <translation>Y, mm</translation>
    </message>
    <message>
        <source>Z, mm</source>
        <translation>Z, mm</translation>
    </message>
    <message>
        <source>A, deg</source>
        <translation>A, Grad</translation>
    </message>
    <message>
        <source>B, deg</source>
        <translation>B, Grad</translation>
    </message>
    <message>
        <source>C, deg</source>
        <translation>C, Grad</translation>
    </message>
    <message>
        <source>the gripper by %1 mm and %2 degrees (X %3  Y %4  Z %5 mm, A %6  B %7  C %8 degrees)</source>
        <translation>den Greifer um %1 mm und %2 Grad (X %3  Y %4  Z %5 mm, A %6  B %7  C %8 Grad)</translation>
    </message>
    <message>
        <source>reached</source>
        <translation>erreicht</translation>
    </message>
    <message>
        <source>stands still</source>
        <translation>steht still</translation>
    </message>
    <message>
        <source>the deviations grow</source>
        <translation>die Abweichungen wachsen</translation>
    </message>
    <message>
        <source>not reached</source>
        <translation>nicht erreicht</translation>
    </message>
    <message>
        <source>ill-conditioned</source>
        <translation>schlecht konditioniert</translation>
    </message>
    <message numerus="yes">
        <source>Servoing, %n move(s): %1, from %2 to %3 mm rms.</source>
        <translation>
            <numerusform>Servoing, %n Bewegung: %1, von %2 auf %3 mm RMS.</numerusform>
            <numerusform>Servoing, %n Bewegungen: %1, von %2 auf %3 mm RMS.</numerusform>
        </translation>
    </message>
    <message>
        <source>One step would leave %1 mm; the two motions are %2 mm and %3 degrees apart.</source>
        <translation>Ein Schritt ließe %1 mm übrig; die beiden Bewegungen liegen %2 mm und %3 Grad auseinander.</translation>
    </message>
    <message>
        <source>Sensitivity: not learnt. Servoing needs it, one step does not.</source>
        <translation>Empfindlichkeit: nicht gelernt. Das Servoing braucht sie, ein Schritt nicht.</translation>
    </message>
    <message>
        <source>Sensitivity: learnt %1 by %2 moves of %3 mm and %4 degrees, condition %5.</source>
        <translation>Empfindlichkeit: gelernt am %1 in %2 Bewegungen von %3 mm und %4 Grad, Kondition %5.</translation>
    </message>
    <message>
        <source>%1 % off the computed one; largest difference: %2, %3 mm a move.</source>
        <translation>%1 % neben der gerechneten; größter Unterschied: %2, %3 mm je Bewegung.</translation>
    </message>
    <message>
        <source>flush of %1</source>
        <translation>Bündigkeit von %1</translation>
    </message>
    <message>
        <source>gap of %1</source>
        <translation>Spalt von %1</translation>
    </message>
    <message>
        <source>Learn it anew, or look at the sensors&apos; calibrations.</source>
        <translation>Sie neu lernen, oder die Kalibrierungen der Sensoren ansehen.</translation>
    </message>
</context>
<context>
    <name>RenameDialog</name>
    <message>
        <source>New name</source>
        <translation>Neuer Name</translation>
    </message>
    <message>
        <source>At most 64 signs, of its own</source>
        <translation>Höchstens 64 Zeichen, kein zweites Mal</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Undo brings the old name back</source>
        <translation>Rückgängig bringt den alten Namen zurück</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>The name stays</source>
        <translation>Der Name bleibt</translation>
    </message>
</context>
</TS>
