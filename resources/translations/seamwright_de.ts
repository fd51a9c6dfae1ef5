<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
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
</context>
<context>
    <name>DeskCommand</name>
    <message>
        <source>spot</source>
        <translation>Messstelle</translation>
    </message>
    <message>
        <source>region</source>
        <translation>Bereich</translation>
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
    <name>Errors</name>
    <message>
        <source>regions corrected and pushed: %1; whether the application began is not recorded yet</source>
        <translation>Regionen korrigiert und übertragen: %1; ob die Anwendung begann, ist noch nicht festgehalten</translation>
    </message>
    <message>
        <source>nothing is released: robot %1: %2</source>
        <translation>nichts ist freigegeben: Roboter %1: %2</translation>
    </message>
    <message>
        <source>nothing is released: robot %1: the application did not begin within %2 s</source>
        <translation>nichts ist freigegeben: Roboter %1: die Anwendung begann nicht innerhalb von %2 s</translation>
    </message>
    <message>
        <source>nothing is released: robot %1: cancelled before the application had taken the permission</source>
        <translation>nichts ist freigegeben: Roboter %1: abgebrochen, bevor die Anwendung die Freigabe übernommen hatte</translation>
    </message>
    <message>
        <source>nothing is released: the program ended before the application had begun; the corrected frames still stand on the controller</source>
        <translation>nichts ist freigegeben: das Programm endete, bevor die Anwendung begann; die korrigierten Frames stehen noch auf der Steuerung</translation>
    </message>
    <message>
        <source>corrected and pushed; the application began after the program had ended</source>
        <translation>korrigiert und übertragen; die Anwendung begann, nachdem das Programm geendet hatte</translation>
    </message>
    <message>
        <source>alarm: a robot did not acknowledge the corrected frames</source>
        <translation>Alarm: ein Roboter hat die korrigierten Frames nicht quittiert</translation>
    </message>
    <message>
        <source>alarm: the push cannot be recorded: %1</source>
        <translation>Alarm: die Übertragung kann nicht festgehalten werden: %1</translation>
    </message>
    <message>
        <source>the project has no region, nothing can be pushed</source>
        <translation>das Projekt hat keine Region, nichts kann übertragen werden</translation>
    </message>
    <message>
        <source>make a region of the spots</source>
        <translation>fassen Sie die Messstellen zu einer Region zusammen</translation>
    </message>
    <message>
        <source>the limit of %1, %2 %3, is none (above 0, up to %4)</source>
        <translation>die Grenze %1, %2 %3, ist keine (über 0, bis %4)</translation>
    </message>
    <message>
        <source>the speed of %1 mm/s is not plausible (0..5000)</source>
        <translation>die Geschwindigkeit von %1 mm/s ist nicht plausibel (0..5000)</translation>
    </message>
    <message>
        <source>entry and exit must be between 0 and 1000 mm</source>
        <translation>Ein- und Auslauf müssen zwischen 0 und 1000 mm liegen</translation>
    </message>
    <message>
        <source>region %1 writes the same frame %2</source>
        <translation>Region %1 schreibt denselben Frame %2</translation>
    </message>
    <message>
        <source>give each region its own frame</source>
        <translation>geben Sie jeder Region ihren eigenen Frame</translation>
    </message>
    <message>
        <source>it names no frame on the controller, nothing can be pushed</source>
        <translation>sie nennt keinen Frame auf der Steuerung, nichts kann übertragen werden</translation>
    </message>
    <message>
        <source>%1 (and %2 more findings, see check)</source>
        <translation>%1 (und %2 weitere Befunde, siehe Prüfung)</translation>
    </message>
    <message>
        <source>the file does not exist</source>
        <translation>die Datei gibt es nicht</translation>
    </message>
    <message>
        <source>the file exists already</source>
        <translation>die Datei gibt es schon</translation>
    </message>
    <message>
        <source>the file exists and is no project file</source>
        <translation>die Datei gibt es schon, und sie ist keine Projektdatei</translation>
    </message>
    <message>
        <source>the file is empty</source>
        <translation>die Datei ist leer</translation>
    </message>
    <message>
        <source>the folder does not exist</source>
        <translation>den Ordner gibt es nicht</translation>
    </message>
    <message>
        <source>this is a folder</source>
        <translation>das ist ein Ordner</translation>
    </message>
    <message>
        <source>this is no file</source>
        <translation>das ist keine Datei</translation>
    </message>
    <message>
        <source>is no file</source>
        <translation>ist keine Datei</translation>
    </message>
    <message>
        <source>the file cannot be made (%1)</source>
        <translation>die Datei lässt sich nicht anlegen (%1)</translation>
    </message>
    <message>
        <source>the file cannot be replaced: %1</source>
        <translation>die Datei lässt sich nicht ersetzen: %1</translation>
    </message>
    <message>
        <source>another program works with the file</source>
        <translation>ein anderes Programm arbeitet mit der Datei</translation>
    </message>
    <message>
        <source>the project is open already (%1, process %2 on %3, since %4)</source>
        <translation>das Projekt ist schon geöffnet (%1, Prozess %2 auf %3, seit %4)</translation>
    </message>
    <message>
        <source>the devices of the project are in use already (%1, process %2 on %3, since %4)</source>
        <translation>die Geräte des Projekts sind schon in Gebrauch (%1, Prozess %2 auf %3, seit %4)</translation>
    </message>
    <message>
        <source>go on there, or close it there first</source>
        <translation>dort weiterarbeiten oder es dort zuerst schließen</translation>
    </message>
    <message>
        <source>disconnect them there, or end it, first</source>
        <translation>sie dort zuerst trennen oder das Programm beenden</translation>
    </message>
    <message>
        <source>the project file could not be brought up to date</source>
        <translation>die Projektdatei ließ sich nicht auf den neuen Stand bringen</translation>
    </message>
    <message>
        <source>choose another name</source>
        <translation>einen anderen Namen wählen</translation>
    </message>
    <message>
        <source>choose a .seam file</source>
        <translation>eine .seam-Datei wählen</translation>
    </message>
    <message>
        <source>close it there or choose another name</source>
        <translation>sie dort schließen oder einen anderen Namen wählen</translation>
    </message>
    <message>
        <source>make it first</source>
        <translation>ihn zuerst anlegen</translation>
    </message>
    <message>
        <source>name a file</source>
        <translation>eine Datei nennen</translation>
    </message>
    <message>
        <source>cannot be read (%1)</source>
        <translation>lässt sich nicht lesen (%1)</translation>
    </message>
    <message>
        <source>holds no readable triangles</source>
        <translation>enthält keine lesbaren Dreiecke</translation>
    </message>
    <message>
        <source>is neither .stl, .ply nor .obj</source>
        <translation>ist weder .stl noch .ply noch .obj</translation>
    </message>
    <message>
        <source>the part is only %1 long: metres suspected</source>
        <translation>das Teil ist nur %1 lang: vermutlich sind es Meter</translation>
    </message>
    <message>
        <source>say the unit: &quot;mm&quot; or &quot;m&quot;</source>
        <translation>die Einheit angeben: „mm“ oder „m“</translation>
    </message>
    <message>
        <source>no project is open</source>
        <translation>kein Projekt ist geöffnet</translation>
    </message>
    <message>
        <source>open or make one</source>
        <translation>eines öffnen oder anlegen</translation>
    </message>
    <message>
        <source>no answer in time</source>
        <translation>keine Antwort in der Zeit</translation>
    </message>
    <message>
        <source>no answer in time: no frame within %1 ms</source>
        <translation>keine Antwort in der Zeit: kein Bild in %1 ms</translation>
    </message>
    <message>
        <source>no answer in time: no trigger within %1 ms</source>
        <translation>keine Antwort in der Zeit: kein Trigger in %1 ms</translation>
    </message>
    <message>
        <source>no answer in time: the next attempt to connect is in %1 ms</source>
        <translation>keine Antwort in der Zeit: der nächste Verbindungsversuch ist in %1 ms</translation>
    </message>
    <message>
        <source>the controller is silent: %1</source>
        <translation>die Steuerung schweigt: %1</translation>
    </message>
    <message>
        <source>another robot answers than before: &quot;%1&quot;, not &quot;%2&quot;</source>
        <translation>es antwortet ein anderer Roboter als vorher: „%1“, nicht „%2“</translation>
    </message>
    <message>
        <source>check the cables and addresses</source>
        <translation>Kabel und Adressen prüfen</translation>
    </message>
    <message>
        <source>the connection was lost while the part was measured</source>
        <translation>die Verbindung ging verloren, während das Teil gemessen wurde</translation>
    </message>
    <message>
        <source>the connection was closed by the other side</source>
        <translation>die Gegenseite hat die Verbindung geschlossen</translation>
    </message>
    <message>
        <source>the connection is closed</source>
        <translation>die Verbindung ist geschlossen</translation>
    </message>
    <message>
        <source>check the cable and the controller</source>
        <translation>Kabel und Steuerung prüfen</translation>
    </message>
    <message>
        <source>check that the controller runs and its program is started</source>
        <translation>prüfen, ob die Steuerung läuft und ihr Programm gestartet ist</translation>
    </message>
    <message>
        <source>nobody connected</source>
        <translation>niemand hat sich verbunden</translation>
    </message>
    <message>
        <source>another program may use this port</source>
        <translation>vielleicht belegt ein anderes Programm diesen Port</translation>
    </message>
    <message>
        <source>cannot listen: %1</source>
        <translation>kann keine Verbindung annehmen: %1</translation>
    </message>
    <message>
        <source>the station is not connected to its devices</source>
        <translation>die Station ist nicht mit ihren Geräten verbunden</translation>
    </message>
    <message>
        <source>its sensor or robot is not connected</source>
        <translation>ihr Sensor oder Roboter ist nicht verbunden</translation>
    </message>
    <message>
        <source>connect first</source>
        <translation>zuerst verbinden</translation>
    </message>
    <message>
        <source>the recording has ended</source>
        <translation>die Aufzeichnung ist zu Ende</translation>
    </message>
    <message>
        <source>the driver &quot;%1&quot; is not known</source>
        <translation>der Treiber „%1“ ist nicht bekannt</translation>
    </message>
    <message>
        <source>the robot is stopped</source>
        <translation>der Roboter ist angehalten</translation>
    </message>
    <message>
        <source>start it on its controller</source>
        <translation>ihn an seiner Steuerung starten</translation>
    </message>
    <message>
        <source>the robot has not moved anywhere yet</source>
        <translation>der Roboter ist noch nirgendwohin gefahren</translation>
    </message>
    <message>
        <source>move the robot first</source>
        <translation>zuerst den Roboter fahren</translation>
    </message>
    <message>
        <source>the robot stands %1 mm and %2 deg off the pose to teach at (%3)</source>
        <translation>der Roboter steht %1 mm und %2 Grad neben der Pose, an der eingelernt wird (%3)</translation>
    </message>
    <message>
        <source>jog it there</source>
        <translation>ihn von Hand dorthin fahren</translation>
    </message>
    <message>
        <source>this robot cannot be moved from the program</source>
        <translation>dieser Roboter lässt sich nicht aus dem Programm fahren</translation>
    </message>
    <message>
        <source>move it by hand and read its position</source>
        <translation>ihn von Hand fahren und seine Position lesen</translation>
    </message>
    <message>
        <source>the controller has no frame &quot;%1&quot;</source>
        <translation>die Steuerung hat kein Frame „%1“</translation>
    </message>
    <message>
        <source>give it in the settings under robot.frames</source>
        <translation>es in den Einstellungen unter robot.frames angeben</translation>
    </message>
    <message>
        <source>the controller holds no measuring program</source>
        <translation>die Steuerung hat kein Messprogramm</translation>
    </message>
    <message>
        <source>load the program that was generated from the project</source>
        <translation>das Programm laden, das aus dem Projekt erzeugt wurde</translation>
    </message>
    <message>
        <source>the measuring program has ended</source>
        <translation>das Messprogramm ist zu Ende</translation>
    </message>
    <message>
        <source>the robot fired for spot &quot;%1&quot;, which is measured already</source>
        <translation>der Roboter löste für Messstelle „%1“ aus, die schon gemessen ist</translation>
    </message>
    <message>
        <source>the robot fired for spot &quot;%1&quot;, which is not in the measuring program</source>
        <translation>der Roboter löste für Messstelle „%1“ aus, die nicht im Messprogramm ist</translation>
    </message>
    <message>
        <source>compare the program on the controller with the project</source>
        <translation>das Programm auf der Steuerung mit dem Projekt vergleichen</translation>
    </message>
    <message>
        <source>check the trigger line between robot and sensor</source>
        <translation>die Triggerleitung zwischen Roboter und Sensor prüfen</translation>
    </message>
    <message>
        <source>the sensor exposed more often than the robot fired</source>
        <translation>der Sensor belichtete öfter, als der Roboter auslöste</translation>
    </message>
    <message>
        <source>the sensor gave no frame</source>
        <translation>der Sensor gab kein Bild</translation>
    </message>
    <message>
        <source>the sensor is not started</source>
        <translation>der Sensor ist nicht gestartet</translation>
    </message>
    <message>
        <source>let the robot measure or trigger the sensor</source>
        <translation>den Roboter messen lassen oder den Sensor auslösen</translation>
    </message>
    <message>
        <source>cancelled</source>
        <translation>abgebrochen</translation>
    </message>
    <message>
        <source>a measurement is running</source>
        <translation>eine Messung läuft</translation>
    </message>
    <message>
        <source>wait for its end or cancel it</source>
        <translation>ihr Ende abwarten oder sie abbrechen</translation>
    </message>
    <message>
        <source>no spot is enabled</source>
        <translation>keine Messstelle ist eingeschaltet</translation>
    </message>
    <message>
        <source>teach a spot first</source>
        <translation>zuerst eine Messstelle einlernen</translation>
    </message>
    <message>
        <source>the feature was found in %1 of %2 measurements (%3)</source>
        <translation>das Merkmal wurde in %1 von %2 Messungen gefunden (%3)</translation>
    </message>
    <message>
        <source>choose another feature or move the sensor</source>
        <translation>ein anderes Merkmal wählen oder den Sensor versetzen</translation>
    </message>
    <message>
        <source>only %1 of %2 measurements agree</source>
        <translation>nur %1 von %2 Messungen stimmen überein</translation>
    </message>
    <message>
        <source>choose another feature, shield reflections or move the sensor</source>
        <translation>ein anderes Merkmal wählen, Reflexe abschirmen oder den Sensor versetzen</translation>
    </message>
    <message>
        <source>a spot needs a sensor and a robot</source>
        <translation>eine Messstelle braucht einen Sensor und einen Roboter</translation>
    </message>
    <message>
        <source>add them first</source>
        <translation>sie zuerst hinzufügen</translation>
    </message>
    <message>
        <source>the name is empty</source>
        <translation>der Name ist leer</translation>
    </message>
    <message>
        <source>give it a name</source>
        <translation>einen Namen geben</translation>
    </message>
    <message>
        <source>the name is longer than 64 signs</source>
        <translation>der Name ist länger als 64 Zeichen</translation>
    </message>
    <message>
        <source>shorten it</source>
        <translation>ihn kürzen</translation>
    </message>
    <message>
        <source>the sensor &quot;%1&quot; is not in the project</source>
        <translation>der Sensor „%1“ ist nicht im Projekt</translation>
    </message>
    <message>
        <source>the robot &quot;%1&quot; is not in the project</source>
        <translation>der Roboter „%1“ ist nicht im Projekt</translation>
    </message>
    <message>
        <source>its sensor &quot;%1&quot; is not in the project</source>
        <translation>ihr Sensor „%1“ ist nicht im Projekt</translation>
    </message>
    <message>
        <source>choose one of the project&apos;s</source>
        <translation>einen des Projekts wählen</translation>
    </message>
    <message>
        <source>choose one of the project&apos;s sensors</source>
        <translation>einen Sensor des Projekts wählen</translation>
    </message>
    <message>
        <source>there is no spot &quot;%1&quot;</source>
        <translation>es gibt keine Messstelle „%1“</translation>
    </message>
    <message>
        <source>no degree of freedom is free</source>
        <translation>kein Freiheitsgrad ist frei</translation>
    </message>
    <message>
        <source>leave at least one free</source>
        <translation>mindestens einen frei lassen</translation>
    </message>
    <message>
        <source>spot %1 uses it</source>
        <translation>Messstelle %1 benutzt ihn</translation>
    </message>
    <message>
        <source>give the spot another sensor first</source>
        <translation>der Messstelle zuerst einen anderen Sensor geben</translation>
    </message>
    <message>
        <source>give the spot another robot first</source>
        <translation>der Messstelle zuerst einen anderen Roboter geben</translation>
    </message>
    <message>
        <source>there are no profiles</source>
        <translation>es gibt keine Profile</translation>
    </message>
    <message>
        <source>record the pass from entry to exit</source>
        <translation>Durchfahrt vom Einlauf bis zum Auslauf aufnehmen</translation>
    </message>
    <message>
        <source>jitter, tolerance and window must be positive numbers</source>
        <translation>Jitter, Toleranz und Fenster müssen positive Zahlen sein</translation>
    </message>
    <message>
        <source>give millimetres above 0</source>
        <translation>Millimeter über 0 angeben</translation>
    </message>
    <message>
        <source>the reference point is not finite</source>
        <translation>der Referenzpunkt ist nicht endlich</translation>
    </message>
    <message>
        <source>give x and z in millimetres</source>
        <translation>x und z in Millimetern angeben</translation>
    </message>
    <message>
        <source>x and z have different numbers of points</source>
        <translation>x und z haben verschieden viele Punkte</translation>
    </message>
    <message>
        <source>give one x and one z a point</source>
        <translation>je Punkt ein x und ein z angeben</translation>
    </message>
    <message>
        <source>a board of %1x%2 points is not possible</source>
        <translation>eine Tafel mit %1x%2 Punkten ist nicht möglich</translation>
    </message>
    <message>
        <source>give columns x rows between 3 and 200, e.g. 7x6</source>
        <translation>Spalten x Zeilen zwischen 3 und 200 angeben, z. B. 7x6</translation>
    </message>
    <message>
        <source>the pitch must be a positive number of millimetres</source>
        <translation>die Teilung muss eine positive Zahl von Millimetern sein</translation>
    </message>
    <message>
        <source>give e.g. 10</source>
        <translation>z. B. 10 angeben</translation>
    </message>
    <message>
        <source>a pitch of %1 mm looks like metres</source>
        <translation>eine Teilung von %1 mm sieht nach Metern aus</translation>
    </message>
    <message>
        <source>give the pitch in millimetres (0.01 m = 10 mm)</source>
        <translation>Teilung in Millimetern angeben (0,01 m = 10 mm)</translation>
    </message>
    <message>
        <source>a pitch beyond one metre looks like micrometres</source>
        <translation>eine Teilung über einem Meter sieht nach Mikrometern aus</translation>
    </message>
    <message>
        <source>give the pitch in millimetres</source>
        <translation>Teilung in Millimetern angeben</translation>
    </message>
    <message>
        <source>the marker must be smaller than its square</source>
        <translation>die Marke muss kleiner sein als ihr Feld</translation>
    </message>
    <message>
        <source>give e.g. 0.75 of the pitch</source>
        <translation>z. B. 0.75 der Teilung angeben</translation>
    </message>
    <message>
        <source>there is no camera %1</source>
        <translation>es gibt keine Kamera %1</translation>
    </message>
    <message>
        <source>cameras count from 0</source>
        <translation>Kameras zählen ab 0</translation>
    </message>
    <message>
        <source>the weight must be 0 or positive</source>
        <translation>das Gewicht muss 0 oder positiv sein</translation>
    </message>
    <message>
        <source>give 1 for an ordinary feature, 0 for none</source>
        <translation>1 für ein gewöhnliches Merkmal, 0 für keines angeben</translation>
    </message>
    <message>
        <source>the feature is not made of finite numbers</source>
        <translation>das Merkmal besteht nicht aus endlichen Zahlen</translation>
    </message>
    <message>
        <source>give it the weight 0</source>
        <translation>ihm das Gewicht 0 geben</translation>
    </message>
    <message>
        <source>fewer than three features were seen</source>
        <translation>es wurden weniger als drei Merkmale gesehen</translation>
    </message>
    <message>
        <source>give three or more</source>
        <translation>drei oder mehr angeben</translation>
    </message>
    <message>
        <source>a feature lies behind its camera at the start</source>
        <translation>ein Merkmal liegt zu Beginn hinter seiner Kamera</translation>
    </message>
    <message>
        <source>give a better start</source>
        <translation>einen besseren Anfang angeben</translation>
    </message>
    <message>
        <source>an image of %1x%2 pixels is not possible</source>
        <translation>ein Bild von %1x%2 Pixeln ist nicht möglich</translation>
    </message>
    <message>
        <source>give width and height of the images in pixels</source>
        <translation>Breite und Höhe der Bilder in Pixeln angeben</translation>
    </message>
    <message>
        <source>there is no view</source>
        <translation>es gibt keine Ansicht</translation>
    </message>
    <message>
        <source>give at least 3 views of the plate</source>
        <translation>mindestens 3 Ansichten der Platte angeben</translation>
    </message>
    <message>
        <source>%1 points but %2 pixels</source>
        <translation>%1 Punkte, aber %2 Pixel</translation>
    </message>
    <message>
        <source>give one pixel per point</source>
        <translation>je Punkt ein Pixel angeben</translation>
    </message>
    <message>
        <source>%1 points are too few for a pose, 4 are needed</source>
        <translation>%1 Punkte sind zu wenige für eine Pose, 4 sind nötig</translation>
    </message>
    <message>
        <source>leave the view out or give more points</source>
        <translation>Ansicht weglassen oder mehr Punkte angeben</translation>
    </message>
    <message>
        <source>point %1 is not a finite number of millimetres and pixels</source>
        <translation>Punkt %1 besteht nicht aus endlichen Millimetern und Pixeln</translation>
    </message>
    <message>
        <source>leave it out</source>
        <translation>weglassen</translation>
    </message>
    <message>
        <source>pixel %1 (%2, %3) lies outside the image of %4x%5</source>
        <translation>Pixel %1 (%2, %3) liegt außerhalb des Bilds von %4x%5</translation>
    </message>
    <message>
        <source>check the image size; all views must have the same</source>
        <translation>Bildgröße prüfen; sie muss für alle Ansichten gleich sein</translation>
    </message>
    <message>
        <source>the points lie on one line</source>
        <translation>die Punkte liegen auf einer Geraden</translation>
    </message>
    <message>
        <source>give points that span a plane</source>
        <translation>Punkte angeben, die eine Ebene aufspannen</translation>
    </message>
    <message>
        <source>the target is %1 mm across, which looks like metres</source>
        <translation>das Ziel misst %1 mm, das sieht nach Metern aus</translation>
    </message>
    <message>
        <source>give its points in millimetres</source>
        <translation>seine Punkte in Millimetern angeben</translation>
    </message>
    <message>
        <source>%1 different view(s) of a plate are too few</source>
        <translation>%1 verschiedene Ansicht(en) einer Platte sind zu wenige</translation>
    </message>
    <message>
        <source>give at least 3, better 10, views with the plate tilted in different directions</source>
        <translation>mindestens 3, besser 10 Ansichten mit verschieden geneigter Platte angeben</translation>
    </message>
    <message>
        <source>no camera explains any of the views</source>
        <translation>keine Kamera erklärt auch nur eine der Ansichten</translation>
    </message>
    <message>
        <source>check the order of the points and the size of the plate</source>
        <translation>Reihenfolge der Punkte und Größe der Platte prüfen</translation>
    </message>
    <message>
        <source>a pose needs at least 4 points, each with a pixel</source>
        <translation>eine Pose braucht mindestens 4 Punkte, jeden mit einem Pixel</translation>
    </message>
    <message>
        <source>give more points</source>
        <translation>mehr Punkte angeben</translation>
    </message>
    <message>
        <source>point %1 is not a finite number</source>
        <translation>Punkt %1 ist keine endliche Zahl</translation>
    </message>
    <message>
        <source>no pose of the target in front of the camera explains its points</source>
        <translation>keine Pose des Ziels vor der Kamera erklärt seine Punkte</translation>
    </message>
    <message>
        <source>check the order of the points and the camera</source>
        <translation>Reihenfolge der Punkte und Kamera prüfen</translation>
    </message>
    <message>
        <source>the sphere&apos;s radius is not a positive number</source>
        <translation>der Radius der Kugel ist keine positive Zahl</translation>
    </message>
    <message>
        <source>the profile has different numbers of x and z</source>
        <translation>das Profil hat verschieden viele x und z</translation>
    </message>
    <message>
        <source>the profile shows no circle of a sphere with radius %1 mm</source>
        <translation>das Profil zeigt keinen Kreis einer Kugel mit Radius %1 mm</translation>
    </message>
    <message>
        <source>let the laser cut the sphere</source>
        <translation>den Laser die Kugel schneiden lassen</translation>
    </message>
    <message>
        <source>there is no measurement</source>
        <translation>es gibt keine Messung</translation>
    </message>
    <message>
        <source>measure two or three spheres</source>
        <translation>zwei oder drei Kugeln messen</translation>
    </message>
    <message>
        <source>a value is not a finite number</source>
        <translation>ein Wert ist keine endliche Zahl</translation>
    </message>
    <message>
        <source>the covariance is not symmetric and positive definite</source>
        <translation>die Kovarianz ist nicht symmetrisch und positiv definit</translation>
    </message>
    <message>
        <source>the limits of the drift check are not positive</source>
        <translation>die Grenzen der Driftprüfung sind nicht positiv</translation>
    </message>
    <message>
        <source>give at least %1 different poses, better eight or more</source>
        <translation>mindestens %1 verschiedene Posen angeben, besser acht oder mehr</translation>
    </message>
    <message>
        <source>the pair is not made of finite numbers</source>
        <translation>das Paar besteht nicht aus endlichen Zahlen</translation>
    </message>
    <message>
        <source>%1 pairs are too few, at least 4 are needed</source>
        <translation>%1 Paare sind zu wenige, mindestens 4 sind nötig</translation>
    </message>
    <message>
        <source>place the body in 10 or more positions over the whole field of view</source>
        <translation>den Körper an 10 oder mehr Stellen über das ganze Messfeld setzen</translation>
    </message>
    <message>
        <source>the laser points span %1 mm, which looks like micrometres</source>
        <translation>die Laserpunkte erstrecken sich über %1 mm, das sieht nach Mikrometern aus</translation>
    </message>
    <message>
        <source>%1, which looks like %2</source>
        <translation>%1, das sieht nach %2 aus</translation>
    </message>
    <message>
        <source>%1 x %2 of %3 bit and %4 x %5 of %6 bit are no pair</source>
        <translation>%1 x %2 mit %3 Bit und %4 x %5 mit %6 Bit sind kein Paar</translation>
    </message>
    <message>
        <source>the id of a %1 is longer than %2 bytes</source>
        <translation>ein Name (%1) ist länger als %2 Bytes</translation>
    </message>
    <message>
        <source>give a shorter name</source>
        <translation>kürzer benennen</translation>
    </message>
    <message>
        <source>the laser points span %1 mm, which looks like metres</source>
        <translation>die Laserpunkte erstrecken sich über %1 mm, das sieht nach Metern aus</translation>
    </message>
    <message>
        <source>give [width, height] in pixels</source>
        <translation>[Breite, Höhe] in Pixeln angeben</translation>
    </message>
    <message>
        <source>there is no line %1 to exclude</source>
        <translation>es gibt keine Linie %1, die auszuschließen wäre</translation>
    </message>
    <message>
        <source>lines count from 0</source>
        <translation>Linien zählen ab 0</translation>
    </message>
    <message>
        <source>%1 points are too few for a line</source>
        <translation>%1 Punkte sind zu wenige für eine Linie</translation>
    </message>
    <message>
        <source>give at least 5</source>
        <translation>mindestens 5 angeben</translation>
    </message>
    <message>
        <source>a point is not finite or lies outside the image</source>
        <translation>ein Punkt ist nicht endlich oder liegt außerhalb des Bilds</translation>
    </message>
    <message>
        <source>all points of the line are the same</source>
        <translation>alle Punkte der Linie sind derselbe</translation>
    </message>
    <message>
        <source>there is no line</source>
        <translation>es gibt keine Linie</translation>
    </message>
    <message>
        <source>give 5 or more lines over the whole image</source>
        <translation>5 oder mehr Linien über das ganze Bild angeben</translation>
    </message>
    <message>
        <source>a step of %1 px is not possible for %2x%3 pixels</source>
        <translation>eine Schrittweite von %1 px ist für %2x%3 Pixel nicht möglich</translation>
    </message>
    <message>
        <source>give e.g. 8</source>
        <translation>z. B. 8 angeben</translation>
    </message>
    <message>
        <source>%1 pairs are too many</source>
        <translation>%1 Paare sind zu viele</translation>
    </message>
    <message>
        <source>thin them out to 100000 or fewer</source>
        <translation>auf 100000 oder weniger ausdünnen</translation>
    </message>
    <message>
        <source>the pixel (%1, %2) lies outside the image of %3x%4</source>
        <translation>das Pixel (%1, %2) liegt außerhalb des Bilds von %3x%4</translation>
    </message>
    <message>
        <source>check the size and the order [u, v]</source>
        <translation>Größe und Reihenfolge [u, v] prüfen</translation>
    </message>
    <message>
        <source>%1 pairs are too few, at least 6 are needed</source>
        <translation>%1 Paare sind zu wenige, mindestens 6 sind nötig</translation>
    </message>
    <message>
        <source>measure 25 or more positions over the whole field of view</source>
        <translation>25 oder mehr Stellen über das ganze Messfeld messen</translation>
    </message>
    <message>
        <source>a coordinate is not a finite number</source>
        <translation>eine Koordinate ist keine endliche Zahl</translation>
    </message>
    <message>
        <source>a coordinate is beyond 100 m on the plate or 1 km in the world</source>
        <translation>eine Koordinate liegt über 100 m auf der Platte oder 1 km in der Welt</translation>
    </message>
    <message>
        <source>give millimetres</source>
        <translation>Millimeter angeben</translation>
    </message>
    <message>
        <source>sigma_mm is not a positive number</source>
        <translation>sigma_mm ist keine positive Zahl</translation>
    </message>
    <message>
        <source>%1 points are too few</source>
        <translation>%1 Punkte sind zu wenige</translation>
    </message>
    <message>
        <source>give at least three, better five or more</source>
        <translation>mindestens drei, besser fünf oder mehr angeben</translation>
    </message>
    <message>
        <source>the plate measures %1 only: its points look like metres, not millimetres</source>
        <translation>die Platte misst nur %1: ihre Punkte sehen nach Metern aus, nicht nach Millimetern</translation>
    </message>
    <message>
        <source>give millimetres (times 1000)</source>
        <translation>Millimeter angeben (mal 1000)</translation>
    </message>
    <message>
        <source>the world points are a thousandth of the plate&apos;s size: they look like metres, not millimetres</source>
        <translation>die Weltpunkte sind ein Tausendstel der Plattengröße: sie sehen nach Metern aus, nicht nach Millimetern</translation>
    </message>
    <message>
        <source>the plate points are a thousandth of the world&apos;s size: they look like metres, not millimetres</source>
        <translation>die Plattenpunkte sind ein Tausendstel der Weltgröße: sie sehen nach Metern aus, nicht nach Millimetern</translation>
    </message>
    <message>
        <source>&apos;%1&apos; and &apos;%2&apos; are the same point of the plate</source>
        <translation>„%1“ und „%2“ sind derselbe Punkt der Platte</translation>
    </message>
    <message>
        <source>give different points, or their mean once</source>
        <translation>verschiedene Punkte angeben oder einmal ihr Mittel</translation>
    </message>
    <message>
        <source>entry %1 has an empty id</source>
        <translation>Eintrag %1 hat eine leere Kennung</translation>
    </message>
    <message>
        <source>give every entry a name</source>
        <translation>jedem Eintrag einen Namen geben</translation>
    </message>
    <message>
        <source>the id &apos;%1&apos; occurs twice</source>
        <translation>die Kennung „%1“ kommt zweimal vor</translation>
    </message>
    <message>
        <source>give every entry a name of its own</source>
        <translation>jedem Eintrag einen eigenen Namen geben</translation>
    </message>
    <message>
        <source>there is no entry &apos;%1&apos; to exclude</source>
        <translation>es gibt keinen Eintrag „%1“, der auszuschließen wäre</translation>
    </message>
    <message>
        <source>name ids that occur in the data</source>
        <translation>Kennungen nennen, die in den Daten vorkommen</translation>
    </message>
    <message>
        <source>no pose is farther than %1 from its base: these look like metres, not millimetres</source>
        <translation>keine Pose ist weiter als %1 von ihrer Basis: das sieht nach Metern aus, nicht nach Millimetern</translation>
    </message>
    <message>
        <source>give translations in millimetres (times 1000)</source>
        <translation>Verschiebungen in Millimetern angeben (mal 1000)</translation>
    </message>
    <message>
        <source>the covariance holds a value that is not a finite number</source>
        <translation>die Kovarianz enthält einen Wert, der keine endliche Zahl ist</translation>
    </message>
    <message>
        <source>the covariance is not symmetric</source>
        <translation>die Kovarianz ist nicht symmetrisch</translation>
    </message>
    <message>
        <source>the covariance is not positive (a variance below zero or a correlation above one)</source>
        <translation>die Kovarianz ist nicht positiv (eine Varianz unter null oder eine Korrelation über eins)</translation>
    </message>
    <message>
        <source>the covariance couples a value that has no variance</source>
        <translation>die Kovarianz verknüpft einen Wert, der keine Varianz hat</translation>
    </message>
    <message>
        <source>there is no sensor</source>
        <translation>es gibt keinen Sensor</translation>
    </message>
    <message>
        <source>give at least one</source>
        <translation>mindestens einen angeben</translation>
    </message>
    <message>
        <source>the working point is not finite</source>
        <translation>der Arbeitspunkt ist nicht endlich</translation>
    </message>
    <message>
        <source>every sensor is excluded</source>
        <translation>alle Sensoren sind ausgeschlossen</translation>
    </message>
    <message>
        <source>the frame id &apos;%1&apos; occurs twice</source>
        <translation>die Bildkennung „%1“ kommt zweimal vor</translation>
    </message>
    <message>
        <source>name frames apart</source>
        <translation>Bilder verschieden benennen</translation>
    </message>
    <message>
        <source>the images have different sizes (%1x%2 and %3x%4)</source>
        <translation>die Bilder sind verschieden groß (%1x%2 und %3x%4)</translation>
    </message>
    <message>
        <source>give frames of one camera at one resolution</source>
        <translation>Bilder einer Kamera mit einer Auflösung angeben</translation>
    </message>
    <message>
        <source>there is no frame &apos;%1&apos; to exclude</source>
        <translation>es gibt kein Bild „%1“, das auszuschließen wäre</translation>
    </message>
    <message>
        <source>name a frame of the set</source>
        <translation>ein Bild der Reihe nennen</translation>
    </message>
    <message>
        <source>there is no frame</source>
        <translation>es gibt kein Bild</translation>
    </message>
    <message>
        <source>give at least 5 frames that show the plate</source>
        <translation>mindestens 5 Bilder angeben, die die Platte zeigen</translation>
    </message>
    <message>
        <source>no board of %1x%2 points was found in any of %3 images</source>
        <translation>in keinem von %3 Bildern wurde eine Tafel mit %1x%2 Punkten gefunden</translation>
    </message>
    <message>
        <source>check the number of inner corners, the light and the focus</source>
        <translation>Zahl der inneren Ecken, Licht und Schärfe prüfen</translation>
    </message>
    <message>
        <source>only %1 different frames show the board, at least 3 are needed</source>
        <translation>nur %1 verschiedene Bilder zeigen die Tafel, mindestens 3 sind nötig</translation>
    </message>
    <message>
        <source>take 8 or more frames with the plate tilted in different directions</source>
        <translation>8 oder mehr Bilder mit verschieden geneigter Platte aufnehmen</translation>
    </message>
    <message>
        <source>no camera explains the boards</source>
        <translation>keine Kamera erklärt die Tafeln</translation>
    </message>
    <message>
        <source>check the number of inner corners</source>
        <translation>Zahl der inneren Ecken prüfen</translation>
    </message>
    <message>
        <source>the robot&apos;s motion is %1 times the board&apos;s: metres were given where millimetres were meant</source>
        <translation>die Bewegung des Roboters ist das %1fache der der Tafel: Meter statt Millimetern angegeben</translation>
    </message>
    <message>
        <source>give both in millimetres</source>
        <translation>beides in Millimetern angeben</translation>
    </message>
    <message>
        <source>by the robot&apos;s motion the pitch of the board is %1 mm, not %2 mm</source>
        <translation>nach der Bewegung des Roboters ist die Teilung der Tafel %1 mm, nicht %2 mm</translation>
    </message>
    <message>
        <source>measure the board</source>
        <translation>Tafel nachmessen</translation>
    </message>
    <message>
        <source>give it in millimetres or null</source>
        <translation>in Millimetern angeben oder null</translation>
    </message>
    <message>
        <source>%1 poses are too few</source>
        <translation>%1 Posen sind zu wenige</translation>
    </message>
    <message>
        <source>give at least %1, better nine or more</source>
        <translation>mindestens %1 angeben, besser neun oder mehr</translation>
    </message>
    <message>
        <source>only %1 of the %2 poses differ from one another</source>
        <translation>nur %1 der %2 Posen unterscheiden sich</translation>
    </message>
    <message>
        <source>give at least %1 different poses, better nine or more</source>
        <translation>mindestens %1 verschiedene Posen angeben, besser neun oder mehr</translation>
    </message>
    <message>
        <source>no profile holds a single point</source>
        <translation>kein Profil enthält auch nur einen Punkt</translation>
    </message>
    <message>
        <source>all profile points lie within %1 in x: these look like metres, not millimetres</source>
        <translation>alle Profilpunkte liegen innerhalb von %1 in x: das sieht nach Metern aus, nicht nach Millimetern</translation>
    </message>
    <message>
        <source>give profile points in millimetres (times 1000)</source>
        <translation>Profilpunkte in Millimetern angeben (mal 1000)</translation>
    </message>
    <message>
        <source>a radius of %1 mm looks like metres</source>
        <translation>ein Radius von %1 mm sieht nach Metern aus</translation>
    </message>
    <message>
        <source>give it in millimetres (times 1000)</source>
        <translation>in Millimetern angeben (mal 1000)</translation>
    </message>
    <message>
        <source>the limits of the radius are empty</source>
        <translation>die Grenzen des Radius sind leer</translation>
    </message>
    <message>
        <source>give a minimum below the maximum</source>
        <translation>ein Minimum unter dem Maximum angeben</translation>
    </message>
    <message>
        <source>a range of x for the corner&apos;s lines is empty</source>
        <translation>ein x-Bereich für die Geraden der Ecke ist leer</translation>
    </message>
    <message>
        <source>give each range a beginning below its end</source>
        <translation>jedem Bereich einen Anfang unter seinem Ende geben</translation>
    </message>
    <message>
        <source>side_length_mm = %1 leaves no points outside of blend_mm = %2</source>
        <translation>side_length_mm = %1 lässt keine Punkte außerhalb von blend_mm = %2</translation>
    </message>
    <message>
        <source>give a longer side</source>
        <translation>eine längere Seite angeben</translation>
    </message>
    <message>
        <source>the window from x = %1 to %2 mm is empty</source>
        <translation>das Fenster von x = %1 bis %2 mm ist leer</translation>
    </message>
    <message>
        <source>the window from z = %1 to %2 mm is empty</source>
        <translation>das Fenster von z = %1 bis %2 mm ist leer</translation>
    </message>
    <message>
        <source>unknown kind of feature &quot;%1&quot;</source>
        <translation>unbekannte Merkmalsart „%1“</translation>
    </message>
    <message>
        <source>known are: %1</source>
        <translation>bekannt sind: %1</translation>
    </message>
    <message>
        <source>the window of gap and flush is empty</source>
        <translation>das Fenster von Spalt und Bündigkeit ist leer</translation>
    </message>
    <message>
        <source>a surface of %1 mm, %2 mm beside the edge, gives no line</source>
        <translation>eine Fläche von %1 mm, %2 mm neben der Kante, ergibt keine Gerade</translation>
    </message>
    <message>
        <source>give 0.1 to 1000 mm of surface and 0 to 100 mm beside the edge</source>
        <translation>0.1 bis 1000 mm Fläche und 0 bis 100 mm neben der Kante angeben</translation>
    </message>
    <message>
        <source>%1 points are no surface</source>
        <translation>%1 Punkte sind keine Fläche</translation>
    </message>
    <message>
        <source>give at least 4</source>
        <translation>mindestens 4 angeben</translation>
    </message>
    <message>
        <source>the template has unequal numbers of x and z</source>
        <translation>die Vorlage hat verschieden viele x und z</translation>
    </message>
    <message>
        <source>the template&apos;s reference point is not finite</source>
        <translation>der Referenzpunkt der Vorlage ist nicht endlich</translation>
    </message>
    <message>
        <source>give two numbers in mm</source>
        <translation>zwei Zahlen in mm angeben</translation>
    </message>
    <message>
        <source>the template has fewer than 5 usable points</source>
        <translation>die Vorlage hat weniger als 5 brauchbare Punkte</translation>
    </message>
    <message>
        <source>take a longer piece of contour</source>
        <translation>ein längeres Stück Kontur nehmen</translation>
    </message>
    <message>
        <source>the template has no extent: its points do not form a contour</source>
        <translation>die Vorlage hat keine Ausdehnung: ihre Punkte bilden keine Kontur</translation>
    </message>
    <message>
        <source>take a piece of contour some millimetres long</source>
        <translation>ein Stück Kontur von einigen Millimetern nehmen</translation>
    </message>
    <message>
        <source>the template has no connected piece of contour</source>
        <translation>die Vorlage enthält kein zusammenhängendes Stück Kontur</translation>
    </message>
    <message>
        <source>take points in sensor order</source>
        <translation>Punkte in der Reihenfolge des Sensors nehmen</translation>
    </message>
    <message>
        <source>the noise is not a length</source>
        <translation>das Rauschen ist keine Länge</translation>
    </message>
    <message>
        <source>give 0 (estimate it) or a positive number</source>
        <translation>0 (schätzen) oder eine positive Zahl angeben</translation>
    </message>
    <message>
        <source>the acceptance band is out of range</source>
        <translation>das Annahmeband liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 1 to 20 standard deviations</source>
        <translation>1 bis 20 Standardabweichungen angeben</translation>
    </message>
    <message>
        <source>the lookahead is out of range</source>
        <translation>die Vorausschau liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 1 to 50 points</source>
        <translation>1 bis 50 Punkte angeben</translation>
    </message>
    <message>
        <source>the weight of the moving average is out of range</source>
        <translation>das Gewicht des gleitenden Mittels liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give a number above 0, at most 1</source>
        <translation>eine Zahl über 0, höchstens 1 angeben</translation>
    </message>
    <message>
        <source>the initial sigma of the spacing is out of range</source>
        <translation>das Anfangs-Sigma des Punktabstands liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give a number above 0, at most 2</source>
        <translation>eine Zahl über 0, höchstens 2 angeben</translation>
    </message>
    <message>
        <source>the shortest segment has no point</source>
        <translation>das kürzeste Segment hat keinen Punkt</translation>
    </message>
    <message>
        <source>give 1 or more</source>
        <translation>1 oder mehr angeben</translation>
    </message>
    <message>
        <source>the columns of the profile differ in length</source>
        <translation>die Spalten des Profils sind verschieden lang</translation>
    </message>
    <message>
        <source>give one x, one z and, if any, one intensity per point</source>
        <translation>je Punkt ein x, ein z und gegebenenfalls eine Helligkeit angeben</translation>
    </message>
    <message>
        <source>the image is empty</source>
        <translation>das Bild ist leer</translation>
    </message>
    <message>
        <source>give a frame with at least one pixel</source>
        <translation>ein Bild mit mindestens einem Pixel angeben</translation>
    </message>
    <message>
        <source>the bit depth %1 is not supported</source>
        <translation>die Bittiefe %1 wird nicht unterstützt</translation>
    </message>
    <message>
        <source>deliver 8, 10, 12 or 16 bit</source>
        <translation>8, 10, 12 oder 16 Bit liefern</translation>
    </message>
    <message>
        <source>a row of %1 bytes is shorter than %2 pixels</source>
        <translation>eine Zeile von %1 Bytes ist kürzer als %2 Pixel</translation>
    </message>
    <message>
        <source>give the distance between rows in bytes</source>
        <translation>den Zeilenabstand in Bytes angeben</translation>
    </message>
    <message>
        <source>the 16-bit rows begin at odd addresses</source>
        <translation>die 16-Bit-Zeilen beginnen an ungeraden Adressen</translation>
    </message>
    <message>
        <source>align the rows to 2 bytes</source>
        <translation>Zeilen auf 2 Bytes ausrichten</translation>
    </message>
    <message>
        <source>the number of peaks a line is out of range</source>
        <translation>die Zahl der Maxima je Linie liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 1 to 64</source>
        <translation>1 bis 64 angeben</translation>
    </message>
    <message>
        <source>the threshold is out of range</source>
        <translation>die Schwelle liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 0 (automatic) to %1 grey values</source>
        <translation>0 (automatisch) bis %1 Grauwerte angeben</translation>
    </message>
    <message>
        <source>the widths are out of range</source>
        <translation>die Breiten liegen außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 0 &lt;= min &lt;= max</source>
        <translation>0 &lt;= min &lt;= max angeben</translation>
    </message>
    <message>
        <source>the smoothing is out of range</source>
        <translation>die Glättung liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>give 0.5 to 20</source>
        <translation>0.5 bis 20 angeben</translation>
    </message>
    <message>
        <source>the candidates have no lines or no room per line</source>
        <translation>die Kandidaten haben keine Linien oder keinen Platz je Linie</translation>
    </message>
    <message>
        <source>give lines &gt;= 0 and per_line &gt;= 1</source>
        <translation>lines &gt;= 0 und per_line &gt;= 1 angeben</translation>
    </message>
    <message>
        <source>the arrays of the candidates differ in length</source>
        <translation>die Felder der Kandidaten sind verschieden lang</translation>
    </message>
    <message>
        <source>give lines counts and lines * per_line values</source>
        <translation>je Linie eine Anzahl und lines * per_line Werte angeben</translation>
    </message>
    <message>
        <source>a line has more candidates than room</source>
        <translation>eine Linie hat mehr Kandidaten als Platz</translation>
    </message>
    <message>
        <source>raise per_line</source>
        <translation>per_line erhöhen</translation>
    </message>
    <message>
        <source>the spot id &quot;%1&quot; occurs twice</source>
        <translation>die Kennung der Messstelle „%1“ kommt zweimal vor</translation>
    </message>
    <message>
        <source>give every spot its own id</source>
        <translation>jeder Messstelle eine eigene Kennung geben</translation>
    </message>
    <message>
        <source>the pose %1</source>
        <translation>die Pose %1</translation>
    </message>
    <message>
        <source>give finite numbers in millimetres</source>
        <translation>endliche Zahlen in Millimetern angeben</translation>
    </message>
    <message>
        <source>the rotation is not orthonormal</source>
        <translation>die Drehung ist nicht orthonormal</translation>
    </message>
    <message>
        <source>give a rotation without scale, shear or mirroring</source>
        <translation>eine Drehung ohne Maßstab, Scherung oder Spiegelung angeben</translation>
    </message>
    <message>
        <source>the reference point %1</source>
        <translation>der Referenzpunkt %1</translation>
    </message>
    <message>
        <source>the measured point %1</source>
        <translation>der gemessene Punkt %1</translation>
    </message>
    <message>
        <source>leave spots that were not measured out of the list</source>
        <translation>nicht gemessene Messstellen weglassen</translation>
    </message>
    <message>
        <source>a weight is negative, not finite or above 1e6</source>
        <translation>ein Gewicht ist negativ, nicht endlich oder über 1e6</translation>
    </message>
    <message>
        <source>use 0 for an axis that is not observed, else 1 or a share of it</source>
        <translation>0 für eine nicht beobachtete Achse angeben, sonst 1 oder einen Anteil davon</translation>
    </message>
    <message>
        <source>a weight lies between 0 and 1e-6</source>
        <translation>ein Gewicht liegt zwischen 0 und 1e-6</translation>
    </message>
    <message>
        <source>use 0 for &quot;not observed&quot;</source>
        <translation>0 für „nicht beobachtet“ angeben</translation>
    </message>
    <message>
        <source>sigma is not a positive number of millimetres</source>
        <translation>Sigma ist keine positive Zahl von Millimetern</translation>
    </message>
    <message>
        <source>give the standard deviation of a measured coordinate, e.g. 0.05</source>
        <translation>die Standardabweichung einer gemessenen Koordinate angeben, z. B. 0.05</translation>
    </message>
    <message>
        <source>the covariance is not a symmetric, positive definite 2 x 2 matrix in mm^2</source>
        <translation>die Kovarianz ist keine symmetrische, positiv definite 2-x-2-Matrix in mm^2</translation>
    </message>
    <message>
        <source>give that of the measured x and z, or sigma_mm alone</source>
        <translation>die der gemessenen x und z angeben oder nur sigma_mm</translation>
    </message>
    <message>
        <source>a covariance is given, but the weights of x and z differ</source>
        <translation>es ist eine Kovarianz angegeben, aber die Gewichte von x und z sind verschieden</translation>
    </message>
    <message>
        <source>give both the same weight, or sigma_mm alone</source>
        <translation>beiden dasselbe Gewicht geben oder nur sigma_mm angeben</translation>
    </message>
    <message>
        <source>the contour curve is not finite or its range is reversed</source>
        <translation>die Konturkurve ist nicht endlich oder ihr Bereich ist verkehrt herum</translation>
    </message>
    <message>
        <source>learn it again from the profiles of the pass</source>
        <translation>neu aus den Profilen der Durchfahrt lernen</translation>
    </message>
    <message>
        <source>there are no spots</source>
        <translation>es gibt keine Messstellen</translation>
    </message>
    <message>
        <source>give at least three in different orientations</source>
        <translation>mindestens drei in verschiedenen Richtungen angeben</translation>
    </message>
    <message>
        <source>name at least one of x, y, z, a, b, c</source>
        <translation>mindestens eines von x, y, z, a, b, c nennen</translation>
    </message>
    <message>
        <source>a limit is negative or not a number</source>
        <translation>eine Grenze ist negativ oder keine Zahl</translation>
    </message>
    <message>
        <source>give limits of at least 0</source>
        <translation>Grenzen von mindestens 0 angeben</translation>
    </message>
    <message>
        <source>a sigma limit is not positive</source>
        <translation>eine Sigma-Grenze ist nicht positiv</translation>
    </message>
    <message>
        <source>give millimetres and degrees above 0</source>
        <translation>Millimeter und Grad über 0 angeben</translation>
    </message>
    <message>
        <source>the outlier significance is not between 0 and 1</source>
        <translation>die Ausreißer-Signifikanz liegt nicht zwischen 0 und 1</translation>
    </message>
    <message>
        <source>use e.g. 0.001</source>
        <translation>z. B. 0.001 verwenden</translation>
    </message>
    <message>
        <source>at least one iteration is needed</source>
        <translation>mindestens eine Iteration ist nötig</translation>
    </message>
    <message>
        <source>use e.g. 50</source>
        <translation>z. B. 50 verwenden</translation>
    </message>
    <message>
        <source>only %1 reference points of the pass are usable</source>
        <translation>nur %1 Referenzpunkte der Durchfahrt sind brauchbar</translation>
    </message>
    <message>
        <source>record at least 5 profiles between entry and exit</source>
        <translation>mindestens 5 Profile zwischen Einlauf und Auslauf aufnehmen</translation>
    </message>
    <message>
        <source>the pass covers only %1 mm of travel</source>
        <translation>die Durchfahrt deckt nur %1 mm Weg ab</translation>
    </message>
    <message>
        <source>record profiles over about 20 mm before and after the trigger position</source>
        <translation>Profile über etwa 20 mm vor und nach der Triggerposition aufnehmen</translation>
    </message>
    <message>
        <source>the reference points do not lie on a curve over the travel</source>
        <translation>die Referenzpunkte liegen nicht auf einer Kurve über dem Weg</translation>
    </message>
    <message>
        <source>record profiles at several different travels</source>
        <translation>Profile an mehreren verschiedenen Wegstellen aufnehmen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is not an IP address</source>
        <translation>„%1“ ist keine IP-Adresse</translation>
    </message>
    <message>
        <source>give it as four numbers, 192.168.1.10</source>
        <translation>als vier Zahlen angeben, 192.168.1.10</translation>
    </message>
    <message>
        <source>it would be open to every computer of the network</source>
        <translation>der Anschluss wäre für jeden Rechner im Netz offen</translation>
    </message>
    <message>
        <source>name the controller&apos;s address in &quot;robot_address&quot;</source>
        <translation>Adresse der Steuerung in &quot;robot_address&quot; nennen</translation>
    </message>
    <message>
        <source>cannot bind: %1</source>
        <translation>der Port kann nicht belegt werden: %1</translation>
    </message>
    <message>
        <source>a datagram of %1 bytes is longer than %2</source>
        <translation>ein Datagramm von %1 Bytes ist länger als %2</translation>
    </message>
    <message>
        <source>there is no %1 &quot;%2&quot;</source>
        <translation>%1 „%2“ gibt es nicht</translation>
    </message>
    <message>
        <source>known are %1</source>
        <translation>bekannt sind %1</translation>
    </message>
    <message>
        <source>this robot has no start signal</source>
        <translation>dieser Roboter hat kein Startsignal</translation>
    </message>
    <message>
        <source>start each run by command</source>
        <translation>jeden Lauf von Hand starten</translation>
    </message>
    <message>
        <source>it has no trigger &quot;%1&quot;</source>
        <translation>sie hat keinen Trigger „%1“</translation>
    </message>
    <message>
        <source>it offers %1</source>
        <translation>sie bietet %1</translation>
    </message>
    <message>
        <source>its triggers cannot be switched off</source>
        <translation>ihre Trigger lassen sich nicht abschalten</translation>
    </message>
    <message>
        <source>the trigger &quot;%1&quot; cannot be set</source>
        <translation>der Trigger „%1“ lässt sich nicht einstellen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no IPv4 address</source>
        <translation>„%1“ ist keine IPv4-Adresse</translation>
    </message>
    <message>
        <source>the camera there has serial number %1, not %2</source>
        <translation>die Kamera dort hat die Seriennummer %1, nicht %2</translation>
    </message>
    <message>
        <source>correct the serial number or the address</source>
        <translation>Seriennummer oder Adresse berichtigen</translation>
    </message>
    <message>
        <source>no network interface leads to it</source>
        <translation>keine Netzwerkschnittstelle führt zu ihr</translation>
    </message>
    <message>
        <source>it cannot be opened (%1)</source>
        <translation>sie lässt sich nicht öffnen (%1)</translation>
    </message>
    <message>
        <source>there is no camera with serial number %1</source>
        <translation>es gibt keine Kamera mit der Seriennummer %1</translation>
    </message>
    <message>
        <source>no camera answers: check power, cable and network</source>
        <translation>keine Kamera antwortet: Versorgung, Kabel und Netz prüfen</translation>
    </message>
    <message>
        <source>these answer: %1</source>
        <translation>es antworten: %1</translation>
    </message>
    <message>
        <source>it has no feature %1</source>
        <translation>sie hat kein Merkmal %1</translation>
    </message>
    <message>
        <source>the feature %1 cannot be set to %2</source>
        <translation>das Merkmal %1 lässt sich nicht auf %2 setzen</translation>
    </message>
    <message>
        <source>another program controls the camera</source>
        <translation>ein anderes Programm steuert die Kamera</translation>
    </message>
    <message>
        <source>close the other program, or wait until its heartbeat has run out</source>
        <translation>das andere Programm schließen oder warten, bis sein Herzschlag abgelaufen ist</translation>
    </message>
    <message>
        <source>none of its pixel formats can be read</source>
        <translation>keines ihrer Pixelformate kann gelesen werden</translation>
    </message>
    <message>
        <source>the pixel format &quot;%1&quot; is not offered or cannot be read</source>
        <translation>das Pixelformat „%1“ wird nicht angeboten oder kann nicht gelesen werden</translation>
    </message>
    <message>
        <source>these can be read: %1</source>
        <translation>lesbar sind: %1</translation>
    </message>
    <message>
        <source>the pixel format cannot be set</source>
        <translation>das Pixelformat lässt sich nicht einstellen</translation>
    </message>
    <message>
        <source>its pixel format &quot;%1&quot; cannot be read</source>
        <translation>ihr Pixelformat „%1“ kann nicht gelesen werden</translation>
    </message>
    <message>
        <source>set pixel_format to one of %1</source>
        <translation>pixel_format auf eines von %1 setzen</translation>
    </message>
    <message>
        <source>it offers no chunks</source>
        <translation>sie bietet keine Chunks</translation>
    </message>
    <message>
        <source>the chunks %1 cannot be switched on</source>
        <translation>die Chunks %1 lassen sich nicht einschalten</translation>
    </message>
    <message>
        <source>the packet size cannot be set</source>
        <translation>die Paketgröße lässt sich nicht einstellen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no parameter of this camera</source>
        <translation>„%1“ ist keine Einstellung dieser Kamera</translation>
    </message>
    <message>
        <source>it has %1</source>
        <translation>sie hat %1</translation>
    </message>
    <message>
        <source>%1 cannot be set to %2</source>
        <translation>%1 lässt sich nicht auf %2 setzen</translation>
    </message>
    <message>
        <source>its distance unit &quot;%1&quot; is no length</source>
        <translation>ihre Längeneinheit „%1“ ist keine Länge</translation>
    </message>
    <message>
        <source>give the scale in the settings under &quot;range&quot;</source>
        <translation>Maßstab in den Einstellungen unter &quot;range&quot; angeben</translation>
    </message>
    <message>
        <source>%1 is out of range %2 to %3</source>
        <translation>%1 liegt nicht im Bereich %2 bis %3</translation>
    </message>
    <message>
        <source>must be a whole number</source>
        <translation>muss eine ganze Zahl sein</translation>
    </message>
    <message>
        <source>must hold texts</source>
        <translation>muss Texte enthalten</translation>
    </message>
    <message>
        <source>must not be 0</source>
        <translation>darf nicht 0 sein</translation>
    </message>
    <message>
        <source>&quot;%1&quot; contradicts hardware_trigger</source>
        <translation>„%1“ widerspricht hardware_trigger</translation>
    </message>
    <message>
        <source>name the camera&apos;s input, e.g. &quot;Line1&quot;</source>
        <translation>den Eingang der Kamera nennen, z. B. &quot;Line1&quot;</translation>
    </message>
    <message>
        <source>must be a number, a text, true, false or null</source>
        <translation>muss eine Zahl, ein Text, true, false oder null sein</translation>
    </message>
    <message>
        <source>must be 0 or at least 200 bytes</source>
        <translation>muss 0 oder mindestens 200 Bytes sein</translation>
    </message>
    <message>
        <source>no camera is named</source>
        <translation>es ist keine Kamera genannt</translation>
    </message>
    <message>
        <source>give &quot;serial&quot;, &quot;address&quot; or &quot;id&quot;</source>
        <translation>&quot;serial&quot;, &quot;address&quot; oder &quot;id&quot; angeben</translation>
    </message>
    <message>
        <source>no answer in time: the camera is gone</source>
        <translation>keine Antwort in der Zeit: die Kamera ist weg</translation>
    </message>
    <message>
        <source>check its power and cable; it is connected again by itself</source>
        <translation>Versorgung und Kabel prüfen; sie wird von selbst wieder verbunden</translation>
    </message>
    <message>
        <source>set pixel_format</source>
        <translation>pixel_format einstellen</translation>
    </message>
    <message>
        <source>the size of its images cannot be read (%1)</source>
        <translation>die Größe ihrer Bilder kann nicht gelesen werden (%1)</translation>
    </message>
    <message>
        <source>no stream can be opened (%1)</source>
        <translation>es lässt sich kein Datenstrom öffnen (%1)</translation>
    </message>
    <message>
        <source>the acquisition cannot be started (%1)</source>
        <translation>die Aufnahme lässt sich nicht starten (%1)</translation>
    </message>
    <message>
        <source>it is not triggered by software but by &quot;%1&quot;</source>
        <translation>sie wird nicht durch Software ausgelöst, sondern durch „%1“</translation>
    </message>
    <message>
        <source>set trigger to &quot;software&quot;</source>
        <translation>Trigger auf &quot;software&quot; stellen</translation>
    </message>
    <message>
        <source>no answer in time: the trigger before this one has no frame yet</source>
        <translation>keine Antwort in der Zeit: der vorige Trigger hat noch kein Bild</translation>
    </message>
    <message>
        <source>the trigger was refused (%1)</source>
        <translation>der Trigger wurde abgelehnt (%1)</translation>
    </message>
    <message>
        <source>no image</source>
        <translation>kein Bild</translation>
    </message>
    <message>
        <source>the answer is shorter than its header</source>
        <translation>die Antwort ist kürzer als ihr Kopf</translation>
    </message>
    <message>
        <source>the answer is no DISCOVERY_ACK</source>
        <translation>die Antwort ist kein DISCOVERY_ACK</translation>
    </message>
    <message>
        <source>the answer is to another question</source>
        <translation>die Antwort gehört zu einer anderen Frage</translation>
    </message>
    <message>
        <source>the camera answers with error 0x%1</source>
        <translation>die Kamera antwortet mit Fehler 0x%1</translation>
    </message>
    <message>
        <source>the answer is cut short</source>
        <translation>die Antwort ist abgeschnitten</translation>
    </message>
    <message>
        <source>check its power and cable</source>
        <translation>Versorgung und Kabel prüfen</translation>
    </message>
    <message>
        <source>holds coordinates, no grey values</source>
        <translation>enthält Koordinaten, keine Grauwerte</translation>
    </message>
    <message>
        <source>an image of %1 x %2 pixels cannot be</source>
        <translation>ein Bild von %1 x %2 Pixeln kann es nicht geben</translation>
    </message>
    <message>
        <source>%1 x %2 pixels need %3 bytes, only %4 came</source>
        <translation>%1 x %2 Pixel brauchen %3 Bytes, nur %4 kamen</translation>
    </message>
    <message>
        <source>packed values are not read as a range image</source>
        <translation>gepackte Werte werden nicht als Höhenbild gelesen</translation>
    </message>
    <message>
        <source>set a pixel format of 8, 16 or 32 bit</source>
        <translation>ein Pixelformat von 8, 16 oder 32 Bit einstellen</translation>
    </message>
    <message>
        <source>there is no row %1 in %2 x %3 points</source>
        <translation>es gibt keine Zeile %1 in %2 x %3 Punkten</translation>
    </message>
    <message>
        <source>%1 x %2 points need %3 bytes, only %4 came</source>
        <translation>%1 x %2 Punkte brauchen %3 Bytes, nur %4 kamen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no result of this format</source>
        <translation>„%1“ ist kein Ergebnis dieses Formats</translation>
    </message>
    <message>
        <source>give the driver the format that is set on the sensor&apos;s Output page</source>
        <translation>dem Treiber das Format geben, das auf der Output-Seite des Sensors eingestellt ist</translation>
    </message>
    <message>
        <source>delimiter and terminator must not be empty</source>
        <translation>Trennzeichen und Endezeichen dürfen nicht leer sein</translation>
    </message>
    <message>
        <source>the format holds an unknown placeholder</source>
        <translation>das Format enthält einen unbekannten Platzhalter</translation>
    </message>
    <message>
        <source>two placeholders of the format stand together</source>
        <translation>zwei Platzhalter des Formats stehen zusammen</translation>
    </message>
    <message>
        <source>put a delimiter between them, on the sensor too</source>
        <translation>ein Trennzeichen dazwischen setzen, auch am Sensor</translation>
    </message>
    <message>
        <source>a line of more than %1 bytes</source>
        <translation>eine Zeile von mehr als %1 Bytes</translation>
    </message>
    <message>
        <source>check the terminator set on the sensor&apos;s Output page</source>
        <translation>das Endezeichen auf der Output-Seite des Sensors prüfen</translation>
    </message>
    <message>
        <source>a %1 message of %2 bytes is too short for what it says</source>
        <translation>eine %1-Nachricht von %2 Bytes ist zu kurz für das, was sie sagt</translation>
    </message>
    <message>
        <source>a message says it has %1 bytes</source>
        <translation>eine Nachricht sagt, sie habe %1 Bytes</translation>
    </message>
    <message>
        <source>check that address and ports are those of a Gocator</source>
        <translation>prüfen, ob Adresse und Ports die eines Gocators sind</translation>
    </message>
    <message>
        <source>must be pairs of the ids of measurements, X and Z</source>
        <translation>müssen Paare von Kennungen der Messungen sein, X und Z</translation>
    </message>
    <message>
        <source>as in [[0, 1]]</source>
        <translation>wie in [[0, 1]]</translation>
    </message>
    <message>
        <source>the address of the sensor is missing</source>
        <translation>die Adresse des Sensors fehlt</translation>
    </message>
    <message>
        <source>as in &quot;192.168.1.10&quot;</source>
        <translation>wie in &quot;192.168.1.10&quot;</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no output</source>
        <translation>„%1“ ist keine Ausgabe</translation>
    </message>
    <message>
        <source>profiles or ascii</source>
        <translation>profiles oder ascii</translation>
    </message>
    <message>
        <source>tell its serial number</source>
        <translation>seine Seriennummer zu nennen</translation>
    </message>
    <message>
        <source>the sensor misses its buddy</source>
        <translation>dem Sensor fehlt sein Partner (Buddy)</translation>
    </message>
    <message>
        <source>connect the second sensor, or remove it on the sensor&apos;s own page</source>
        <translation>den zweiten Sensor anschließen oder auf der Seite des Sensors entfernen</translation>
    </message>
    <message>
        <source>the sensor with the serial number %1 answers, not %2</source>
        <translation>es antwortet der Sensor mit der Seriennummer %1, nicht %2</translation>
    </message>
    <message>
        <source>check address and cabling</source>
        <translation>Adresse und Verkabelung prüfen</translation>
    </message>
    <message>
        <source>the sensor is fired by its digital input</source>
        <translation>der Sensor wird durch seinen digitalen Eingang ausgelöst</translation>
    </message>
    <message>
        <source>switch hardware_trigger off to fire it from here</source>
        <translation>hardware_trigger abschalten, um ihn von hier auszulösen</translation>
    </message>
    <message>
        <source>be triggered: is its job set to software triggers?</source>
        <translation>auszulösen: steht sein Job auf Software-Trigger?</translation>
    </message>
    <message>
        <source>the connection was closed by the other side: it does not answer</source>
        <translation>die Verbindung wurde von der anderen Seite geschlossen: er antwortet nicht</translation>
    </message>
    <message>
        <source>its job sends no profile of this source: tick it on its Output page</source>
        <translation>sein Job sendet kein Profil dieser Quelle: auf seiner Output-Seite ankreuzen</translation>
    </message>
    <message>
        <source>there is no parameter &quot;%1&quot;</source>
        <translation>es gibt keine Einstellung „%1“</translation>
    </message>
    <message>
        <source>set it on the sensor&apos;s own page</source>
        <translation>auf der Seite des Sensors einstellen</translation>
    </message>
    <message>
        <source>the sensor refuses to %1 (status %2)</source>
        <translation>der Sensor weigert sich, %1 (Status %2)</translation>
    </message>
    <message>
        <source>start its job</source>
        <translation>seinen Job zu starten</translation>
    </message>
    <message>
        <source>check power, cable and address of the sensor</source>
        <translation>Strom, Kabel und Adresse des Sensors prüfen</translation>
    </message>
    <message>
        <source>no answer in time: the sensor did not %1 its job within %2 s</source>
        <translation>keine Antwort in der Zeit: der Sensor hat seinen Job nicht ausgeführt (%1) innerhalb von %2 s</translation>
    </message>
    <message>
        <source>look on the sensor&apos;s own page; start_timeout_ms is how long to wait</source>
        <translation>auf der eigenen Seite des Sensors nachsehen; start_timeout_ms sagt, wie lange gewartet wird</translation>
    </message>
    <message>
        <source>given up before the sensor answered</source>
        <translation>aufgegeben, bevor der Sensor geantwortet hat</translation>
    </message>
    <message>
        <source>a %1 message says it has %2 profiles</source>
        <translation>eine Nachricht (%1) nennt %2 Profile</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no name of a frame</source>
        <translation>„%1“ ist kein Name eines Frames</translation>
    </message>
    <message>
        <source>the frame is not finite or beyond 100 m</source>
        <translation>der Frame ist nicht endlich oder über 100 m</translation>
    </message>
    <message>
        <source>the pose is not finite</source>
        <translation>die Pose ist nicht endlich</translation>
    </message>
    <message>
        <source>no answer in time: no robot has connected</source>
        <translation>keine Antwort in der Zeit: kein Roboter hat sich verbunden</translation>
    </message>
    <message>
        <source>start SEAMWRIGHT_SUB in the controller&apos;s submit interpreter</source>
        <translation>SEAMWRIGHT_SUB im Submit-Interpreter der Steuerung starten</translation>
    </message>
    <message>
        <source>the controller does not know the flange: %1</source>
        <translation>die Steuerung kennt den Flansch nicht: %1</translation>
    </message>
    <message>
        <source>select and start a program on the controller</source>
        <translation>auf der Steuerung ein Programm anwählen und starten</translation>
    </message>
    <message>
        <source>load seamwright_sub.sub of this version on the controller</source>
        <translation>seamwright_sub.sub dieser Version auf die Steuerung laden</translation>
    </message>
    <message>
        <source>the tool is fixed in the cell ($IPO_MODE #TCP): the flange is not told</source>
        <translation>das Werkzeug steht fest in der Zelle ($IPO_MODE #TCP): der Flansch wird nicht gemeldet</translation>
    </message>
    <message>
        <source>select a program whose tool is on the robot</source>
        <translation>ein Programm anwählen, dessen Werkzeug am Roboter ist</translation>
    </message>
    <message>
        <source>select and start a program, so that tool and base are active</source>
        <translation>ein Programm anwählen und starten, damit Werkzeug und Basis gelten</translation>
    </message>
    <message>
        <source>tool or base changed while the flange was read</source>
        <translation>Werkzeug oder Basis haben gewechselt, während der Flansch gelesen wurde</translation>
    </message>
    <message>
        <source>read it again</source>
        <translation>noch einmal lesen</translation>
    </message>
    <message>
        <source>no program waits in SEAMWRIGHT_SPOTS</source>
        <translation>kein Programm wartet in SEAMWRIGHT_SPOTS</translation>
    </message>
    <message>
        <source>start the application on the controller</source>
        <translation>die Anwendung auf der Steuerung starten</translation>
    </message>
    <message>
        <source>the program that waited did not go on</source>
        <translation>das wartende Programm ging nicht weiter</translation>
    </message>
    <message>
        <source>the application runs with the frames already</source>
        <translation>die Anwendung läuft schon mit den Frames</translation>
    </message>
    <message>
        <source>the controller reports: %1</source>
        <translation>die Steuerung meldet: %1</translation>
    </message>
    <message>
        <source>the controller refuses &quot;%1&quot;: %2</source>
        <translation>die Steuerung lehnt „%1“ ab: %2</translation>
    </message>
    <message>
        <source>another measuring program is loaded than the project&apos;s</source>
        <translation>geladen ist ein anderes Messprogramm als das des Projekts</translation>
    </message>
    <message>
        <source>load the one that `seamwright robot-program` writes</source>
        <translation>das laden, das `seamwright robot-program` schreibt</translation>
    </message>
    <message>
        <source>the measuring program runs already</source>
        <translation>das Messprogramm läuft schon</translation>
    </message>
    <message>
        <source>the controller did not keep the verdict</source>
        <translation>die Steuerung hat das Ergebnis nicht behalten</translation>
    </message>
    <message>
        <source>moving by command wants T1 with the program SEAMWRIGHT running</source>
        <translation>Bewegen auf Befehl verlangt T1 und das laufende Programm SEAMWRIGHT</translation>
    </message>
    <message>
        <source>the connection was closed by the other side, the next attempt is due soon</source>
        <translation>die Verbindung wurde von der anderen Seite geschlossen, der nächste Versuch kommt gleich</translation>
    </message>
    <message>
        <source>check that KUKAVARPROXY runs on the controller</source>
        <translation>prüfen, ob KUKAVARPROXY auf der Steuerung läuft</translation>
    </message>
    <message>
        <source>the controller refuses to read %1</source>
        <translation>die Steuerung lehnt es ab, %1 zu lesen</translation>
    </message>
    <message>
        <source>load seamwright.dat on the controller</source>
        <translation>seamwright.dat auf die Steuerung laden</translation>
    </message>
    <message>
        <source>the controller refuses to write %1</source>
        <translation>die Steuerung lehnt es ab, %1 zu schreiben</translation>
    </message>
    <message>
        <source>check the operating mode and that the variable is global</source>
        <translation>Betriebsart prüfen, und ob die Variable global ist</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is not known</source>
        <translation>„%1“ ist nicht bekannt</translation>
    </message>
    <message>
        <source>relative corrections in the tool do not add up</source>
        <translation>relative Korrekturen im Werkzeug lassen sich nicht aufaddieren</translation>
    </message>
    <message>
        <source>use base, or absolute</source>
        <translation>base oder absolute verwenden</translation>
    </message>
    <message>
        <source>not a name that XML can hold</source>
        <translation>kein Name, den XML halten kann</translation>
    </message>
    <message>
        <source>not a whole number from 1 to 9</source>
        <translation>keine ganze Zahl von 1 bis 9</translation>
    </message>
    <message>
        <source>check that KUKAVARPROXY answers on this port</source>
        <translation>prüfen, ob KUKAVARPROXY auf diesem Port antwortet</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no frame</source>
        <translation>„%1“ ist kein Frame</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no number of a frame</source>
        <translation>„%1“ ist keine Zahl eines Frames</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no position of a robot</source>
        <translation>„%1“ ist keine Position eines Roboters</translation>
    </message>
    <message>
        <source>the frame has no %1</source>
        <translation>dem Frame fehlt %1</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is neither TRUE nor FALSE</source>
        <translation>„%1“ ist weder TRUE noch FALSE</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no whole number</source>
        <translation>„%1“ ist keine ganze Zahl</translation>
    </message>
    <message>
        <source>is no XML: %1</source>
        <translation>ist kein XML: %1</translation>
    </message>
    <message>
        <source>the root is not %1</source>
        <translation>die Wurzel ist nicht %1</translation>
    </message>
    <message>
        <source>load Seamwright.xml of this version on the controller</source>
        <translation>Seamwright.xml dieser Version auf die Steuerung laden</translation>
    </message>
    <message>
        <source>lacks Kind, Name or Text</source>
        <translation>es fehlt Kind, Name oder Text</translation>
    </message>
    <message>
        <source>has no number Id</source>
        <translation>hat keine Nummer Id</translation>
    </message>
    <message>
        <source>has no number Pos/%1</source>
        <translation>hat keine Zahl Pos/%1</translation>
    </message>
    <message>
        <source>Pos/%1 = %2 is no position of a robot</source>
        <translation>Pos/%1 = %2 ist keine Position eines Roboters</translation>
    </message>
    <message>
        <source>is longer than %1 bytes</source>
        <translation>ist länger als %1 Bytes</translation>
    </message>
    <message>
        <source>check that Seamwright&apos;s module talks on this port</source>
        <translation>prüfen, ob das Modul von Seamwright auf diesem Port spricht</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no operating mode</source>
        <translation>„%1“ ist keine Betriebsart</translation>
    </message>
    <message>
        <source>an RSI telegram is refused: %1</source>
        <translation>ein RSI-Telegramm wird abgelehnt: %1</translation>
    </message>
    <message>
        <source>it is too long</source>
        <translation>es ist zu lang</translation>
    </message>
    <message>
        <source>it has no IPOC of digits</source>
        <translation>es hat keine IPOC aus Ziffern</translation>
    </message>
    <message>
        <source>known are path, sensor</source>
        <translation>bekannt sind path, sensor</translation>
    </message>
    <message>
        <source>%1 is not in %2 to %3</source>
        <translation>%1 liegt nicht in %2 bis %3</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no name for a spot on an ABB controller</source>
        <translation>„%1“ ist kein Name für eine Messstelle auf einer ABB-Steuerung</translation>
    </message>
    <message>
        <source>use at most 32 characters without blanks, quotes and backslashes</source>
        <translation>höchstens 32 Zeichen ohne Leerzeichen, Anführungszeichen und Rückstriche verwenden</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no name of a work object</source>
        <translation>„%1“ ist kein Name eines Werkobjekts</translation>
    </message>
    <message>
        <source>use a letter, then letters, digits and _, at most 32 characters</source>
        <translation>einen Buchstaben, dann Buchstaben, Ziffern und _ verwenden, höchstens 32 Zeichen</translation>
    </message>
    <message>
        <source>the pose is not finite or beyond 1e5 mm</source>
        <translation>die Pose ist nicht endlich oder über 1e5 mm</translation>
    </message>
    <message>
        <source>the controller&apos;s module and this program must speak the same version</source>
        <translation>das Modul der Steuerung und dieses Programm müssen dieselbe Version sprechen</translation>
    </message>
    <message>
        <source>no answer in time: half a message came</source>
        <translation>keine Antwort in der Zeit: eine halbe Nachricht kam</translation>
    </message>
    <message>
        <source>the controller floods with events</source>
        <translation>die Steuerung überschüttet mit Ereignissen</translation>
    </message>
    <message>
        <source>an event &quot;%1&quot; without its number came</source>
        <translation>ein Ereignis „%1“ ohne seine Nummer kam</translation>
    </message>
    <message>
        <source>start signal %1 came after %2</source>
        <translation>Startsignal %1 kam nach %2</translation>
    </message>
    <message>
        <source>a start signal was lost; the part has to be started again</source>
        <translation>ein Startsignal ging verloren; das Teil muss neu gestartet werden</translation>
    </message>
    <message>
        <source>the program ended after %1 triggers, of which %2 came</source>
        <translation>das Programm endete nach %1 Triggern, von denen %2 kamen</translation>
    </message>
    <message>
        <source>a trigger was lost; the part has to be measured again</source>
        <translation>ein Trigger ging verloren; das Teil muss neu gemessen werden</translation>
    </message>
    <message>
        <source>the controller sent an unknown event &quot;%1&quot;</source>
        <translation>die Steuerung sandte ein unbekanntes Ereignis „%1“</translation>
    </message>
    <message>
        <source>trigger %1 came instead of %2</source>
        <translation>Trigger %1 kam statt %2</translation>
    </message>
    <message>
        <source>the controller refuses %1: %2</source>
        <translation>die Steuerung lehnt %1 ab: %2</translation>
    </message>
    <message>
        <source>an EGM message is refused: %1</source>
        <translation>eine EGM-Nachricht wird abgelehnt: %1</translation>
    </message>
    <message>
        <source>its type is not DATA</source>
        <translation>ihre Art ist nicht DATA</translation>
    </message>
    <message>
        <source>its type is not PATH_CORRECTION</source>
        <translation>ihre Art ist nicht PATH_CORRECTION</translation>
    </message>
    <message>
        <source>the correction is incomplete</source>
        <translation>die Korrektur ist unvollständig</translation>
    </message>
    <message>
        <source>the correction is not finite</source>
        <translation>die Korrektur ist nicht endlich</translation>
    </message>
    <message>
        <source>a message of %1 bytes came, they have %2</source>
        <translation>eine Nachricht von %1 Bytes kam, sie haben %2</translation>
    </message>
    <message>
        <source>line %1 of a message is not 79 printable characters and a line feed</source>
        <translation>Zeile %1 einer Nachricht sind nicht 79 druckbare Zeichen und ein Zeilenvorschub</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no message: number and word are missing</source>
        <translation>„%1“ ist keine Nachricht: Nummer und Wort fehlen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no position of three finite numbers</source>
        <translation>„%1“ ist keine Position aus drei endlichen Zahlen</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no quaternion of four finite numbers</source>
        <translation>„%1“ ist kein Quaternion aus vier endlichen Zahlen</translation>
    </message>
    <message>
        <source>%1 mm is no position of a robot</source>
        <translation>%1 mm ist keine Position eines Roboters</translation>
    </message>
    <message>
        <source>a robot reaches less than 1e5 mm</source>
        <translation>ein Roboter reicht weniger als 1e5 mm weit</translation>
    </message>
    <message>
        <source>start its program on the controller</source>
        <translation>sein Programm auf der Steuerung starten</translation>
    </message>
    <message>
        <source>check that the controller is on</source>
        <translation>prüfen, ob die Steuerung eingeschaltet ist</translation>
    </message>
    <message>
        <source>the module seamwright.script does not run</source>
        <translation>das Modul seamwright.script läuft nicht</translation>
    </message>
    <message>
        <source>load what `seamwright robot-program --brand ur` writes and start the program</source>
        <translation>laden, was `seamwright robot-program --brand ur` schreibt, und das Programm starten</translation>
    </message>
    <message>
        <source>the controller refuses: %1</source>
        <translation>die Steuerung lehnt ab: %1</translation>
    </message>
    <message>
        <source>%1 of %2 bytes is no answer of RTDE</source>
        <translation>%1 von %2 Bytes ist keine RTDE-Antwort</translation>
    </message>
    <message>
        <source>a package of %1 bytes is no answer of RTDE</source>
        <translation>ein Paket von %1 Bytes ist keine RTDE-Antwort</translation>
    </message>
    <message>
        <source>a package of type %1 is no answer of RTDE</source>
        <translation>ein Paket der Art %1 ist keine RTDE-Antwort</translation>
    </message>
    <message>
        <source>the answer names an unknown type &quot;%1&quot; for %2</source>
        <translation>die Antwort nennt für %2 eine unbekannte Art „%1“</translation>
    </message>
    <message>
        <source>the answer has %1 types for %2 variables</source>
        <translation>die Antwort hat %1 Arten für %2 Variablen</translation>
    </message>
    <message>
        <source>another program already writes %1</source>
        <translation>ein anderes Programm schreibt schon %1</translation>
    </message>
    <message>
        <source>end it, disable EtherNet/IP and PROFINET on those registers, or choose others by &quot;first_register&quot;</source>
        <translation>es beenden, EtherNet/IP und PROFINET auf diesen Registern abschalten oder andere mit &quot;first_register&quot; wählen</translation>
    </message>
    <message>
        <source>the controller does not know %1</source>
        <translation>die Steuerung kennt %1 nicht</translation>
    </message>
    <message>
        <source>its software is too old for this driver (PolyScope 3.4 and later)</source>
        <translation>ihre Software ist zu alt für diesen Treiber (ab PolyScope 3.4)</translation>
    </message>
    <message>
        <source>data of %1 bytes came for a recipe of %2</source>
        <translation>Daten von %1 Bytes kamen für ein Rezept von %2</translation>
    </message>
    <message>
        <source>data of another recipe came</source>
        <translation>Daten eines anderen Rezepts kamen</translation>
    </message>
    <message>
        <source>%1 is neither true nor false</source>
        <translation>%1 ist weder wahr noch falsch</translation>
    </message>
    <message>
        <source>%1 %2 is no position of a robot</source>
        <translation>%1 %2 ist keine Position eines Roboters</translation>
    </message>
    <message>
        <source>the controller&apos;s program was stopped while it measured</source>
        <translation>das Programm der Steuerung wurde beim Messen angehalten</translation>
    </message>
    <message>
        <source>start it on the controller and measure the part again</source>
        <translation>an der Steuerung starten und das Teil noch einmal messen</translation>
    </message>
    <message>
        <source>the controller refuses: no robot program waits in sw_measure()</source>
        <translation>die Steuerung lehnt ab: kein Roboterprogramm wartet in sw_measure()</translation>
    </message>
    <message>
        <source>%1 is not within %2 and %3</source>
        <translation>%1 liegt nicht zwischen %2 und %3</translation>
    </message>
    <message>
        <source>the settings are no object</source>
        <translation>die Einstellungen sind kein Objekt</translation>
    </message>
    <message>
        <source>unknown field</source>
        <translation>unbekanntes Feld</translation>
    </message>
    <message>
        <source>leave it out or correct its name</source>
        <translation>weglassen oder seinen Namen berichtigen</translation>
    </message>
    <message>
        <source>not a whole number</source>
        <translation>keine ganze Zahl</translation>
    </message>
    <message>
        <source>not an object of frames</source>
        <translation>kein Objekt von Frames</translation>
    </message>
    <message>
        <source>a cyclic correction cannot measure</source>
        <translation>eine zyklische Korrektur kann nicht messen</translation>
    </message>
    <message>
        <source>name the driver that runs the measuring program</source>
        <translation>den Treiber nennen, der das Messprogramm ausführt</translation>
    </message>
    <message>
        <source>no measuring link can be opened here</source>
        <translation>hier lässt sich keine Verbindung zum Messen öffnen</translation>
    </message>
    <message>
        <source>the correction is withdrawn; look at the robot</source>
        <translation>die Korrektur ist zurückgenommen; nach dem Roboter sehen</translation>
    </message>
    <message>
        <source>no answer in time: no cyclic packet came to port %1</source>
        <translation>keine Antwort in der Zeit: kein zyklisches Paket kam an Port %1</translation>
    </message>
    <message>
        <source>check that the robot&apos;s program has switched the correction on</source>
        <translation>prüfen, ob das Programm des Roboters die Korrektur eingeschaltet hat</translation>
    </message>
    <message>
        <source>the cyclic packets carry no position</source>
        <translation>die zyklischen Pakete tragen keine Position</translation>
    </message>
    <message>
        <source>send the Cartesian actual position</source>
        <translation>die kartesische Istposition senden</translation>
    </message>
    <message>
        <source>the robot at %1 is another one than at %2</source>
        <translation>der Roboter unter %1 ist ein anderer als unter %2</translation>
    </message>
    <message>
        <source>open the project&apos;s robot again</source>
        <translation>den Roboter des Projekts neu öffnen</translation>
    </message>
    <message>
        <source>the robot&apos;s packets carry no %1</source>
        <translation>die Pakete des Roboters tragen kein %1</translation>
    </message>
    <message>
        <source>without it nobody knows what the robot does; send it too</source>
        <translation>ohne das weiß niemand, was der Roboter tut; es mitsenden</translation>
    </message>
    <message>
        <source>the correction is not in force: %1</source>
        <translation>die Korrektur wirkt nicht: %1</translation>
    </message>
    <message>
        <source>the robot fell silent under a correction</source>
        <translation>der Roboter ist unter einer Korrektur verstummt</translation>
    </message>
    <message>
        <source>too many late or lost packets under a correction</source>
        <translation>zu viele verspätete oder verlorene Pakete unter einer Korrektur</translation>
    </message>
    <message>
        <source>the robot repeats old cycle numbers</source>
        <translation>der Roboter wiederholt alte Zyklusnummern</translation>
    </message>
    <message>
        <source>the robot began a new session under a correction</source>
        <translation>der Roboter hat unter einer Korrektur eine neue Sitzung begonnen</translation>
    </message>
    <message>
        <source>the robot has dropped the correction by itself</source>
        <translation>der Roboter hat die Korrektur von selbst fallen lassen</translation>
    </message>
    <message>
        <source>the robot does not follow: it shows a correction of %1 mm and %2 degrees where it took %3 mm and %4 degrees</source>
        <translation>der Roboter folgt nicht: er zeigt eine Korrektur von %1 mm und %2 Grad, wo er %3 mm und %4 Grad übernommen hat</translation>
    </message>
    <message>
        <source>the robot was found with a correction of %1 mm that was not told it; it is led back</source>
        <translation>der Roboter wurde mit einer Korrektur von %1 mm angetroffen, die ihm nicht gesagt worden ist; sie wird zurückgeführt</translation>
    </message>
    <message>
        <source>the controller left the state in which it takes corrections</source>
        <translation>die Steuerung hat den Zustand verlassen, in dem sie Korrekturen annimmt</translation>
    </message>
    <message>
        <source>the robot&apos;s position jumped further than it can move</source>
        <translation>die Position des Roboters ist weiter gesprungen, als er fahren kann</translation>
    </message>
    <message>
        <source>the correction left its limit on the way</source>
        <translation>die Korrektur hat unterwegs ihre Grenze verlassen</translation>
    </message>
    <message>
        <source>the robot tells a position that it cannot have</source>
        <translation>der Roboter nennt eine Position, die er nicht haben kann</translation>
    </message>
    <message>
        <source>a cyclic correction alone cannot measure</source>
        <translation>eine zyklische Korrektur allein kann nicht messen</translation>
    </message>
    <message>
        <source>name a measuring driver in the settings (&quot;measuring&quot;)</source>
        <translation>einen messenden Treiber in den Einstellungen nennen (&quot;measuring&quot;)</translation>
    </message>
    <message>
        <source>a cyclic correction alone has no triggers</source>
        <translation>eine zyklische Korrektur allein hat keine Trigger</translation>
    </message>
    <message>
        <source>no frame of this name is in the settings</source>
        <translation>kein Frame dieses Namens steht in den Einstellungen</translation>
    </message>
    <message>
        <source>add it under &quot;frames&quot;</source>
        <translation>unter &quot;frames&quot; hinzufügen</translation>
    </message>
    <message>
        <source>the frame is not finite</source>
        <translation>der Frame ist nicht endlich</translation>
    </message>
    <message>
        <source>refused: the correction of %1 mm is beyond the limit of %2 mm</source>
        <translation>abgelehnt: die Korrektur von %1 mm liegt über der Grenze von %2 mm</translation>
    </message>
    <message>
        <source>refused: the correction of %1 degrees is beyond the limit of %2</source>
        <translation>abgelehnt: die Korrektur von %1 Grad liegt über der Grenze von %2</translation>
    </message>
    <message>
        <source>frames %1 and %2 want different corrections</source>
        <translation>die Frames %1 und %2 wollen verschiedene Korrekturen</translation>
    </message>
    <message>
        <source>the controller holds one at a time</source>
        <translation>die Steuerung hält eine zur Zeit</translation>
    </message>
    <message>
        <source>the controller does not take corrections: it is not running</source>
        <translation>die Steuerung nimmt keine Korrekturen an: sie läuft nicht</translation>
    </message>
    <message>
        <source>start its program</source>
        <translation>ihr Programm starten</translation>
    </message>
    <message>
        <source>no answer in time: the correction is not in force</source>
        <translation>keine Antwort in der Zeit: die Korrektur ist nicht in Kraft</translation>
    </message>
    <message>
        <source>no answer in time: the correction could not be led back to zero</source>
        <translation>keine Antwort in der Zeit: die Korrektur konnte nicht auf null zurückgeführt werden</translation>
    </message>
    <message>
        <source>stop the robot&apos;s program</source>
        <translation>das Programm des Roboters anhalten</translation>
    </message>
    <message>
        <source>known are exposure_us, gain_db, laser, scene</source>
        <translation>bekannt sind exposure_us, gain_db, laser, scene</translation>
    </message>
    <message>
        <source>a pose of the move is not finite</source>
        <translation>eine Pose der Bewegung ist nicht endlich</translation>
    </message>
    <message>
        <source>it was changed while its reference was measured</source>
        <translation>sie wurde geändert, während ihre Referenz gemessen wurde</translation>
    </message>
    <message>
        <source>measure the reference again</source>
        <translation>die Referenz noch einmal messen</translation>
    </message>
    <message>
        <source>less of the template is seen than required</source>
        <translation>es ist weniger von der Vorlage zu sehen als gefordert</translation>
    </message>
    <message>
        <source>no round piece of contour in the window</source>
        <translation>kein rundes Stück Kontur im Fenster</translation>
    </message>
    <message>
        <source>no stripe was found in the image</source>
        <translation>im Bild wurde kein Streifen gefunden</translation>
    </message>
    <message>
        <source>no surface in the window</source>
        <translation>keine Fläche im Fenster</translation>
    </message>
    <message>
        <source>only one surface in the window: the contour is not broken by a gap</source>
        <translation>nur eine Fläche im Fenster: die Kontur ist von keinem Spalt unterbrochen</translation>
    </message>
    <message>
        <source>the contour has no smooth extremum there, it ends or has an edge</source>
        <translation>die Kontur hat dort kein glattes Extremum, sie endet oder hat eine Kante</translation>
    </message>
    <message>
        <source>the contour is flat there: no bow is seen above the noise</source>
        <translation>die Kontur ist dort eben: über dem Rauschen ist kein Bogen zu sehen</translation>
    </message>
    <message>
        <source>the contour may slide along itself: the template needs an edge or a bend</source>
        <translation>die Kontur kann auf sich selbst gleiten: die Vorlage braucht eine Kante oder einen Bogen</translation>
    </message>
    <message>
        <source>the contour runs on beyond the window on that side</source>
        <translation>die Kontur läuft auf dieser Seite über das Fenster hinaus weiter</translation>
    </message>
    <message>
        <source>several contours end on that side: %1; say which by the window or by the setting segment</source>
        <translation>mehrere Konturen enden auf dieser Seite: %1; welche gemeint ist, sagt das Fenster oder die Einstellung Segment</translation>
    </message>
    <message>
        <source>a contour ends on that side, %1, and another one leaves the sensor&apos;s field there; say which by the window or by the setting segment</source>
        <translation>eine Kontur endet auf dieser Seite, %1, eine andere verlässt dort das Feld des Sensors; welche gemeint ist, sagt das Fenster oder die Einstellung Segment</translation>
    </message>
    <message>
        <source>two contours are about equally long: %1; say which by the window or by the setting segment</source>
        <translation>zwei Konturen sind etwa gleich lang: %1; welche gemeint ist, sagt das Fenster oder die Einstellung Segment</translation>
    </message>
    <message>
        <source>two contours are equally high: %1; say which by the window or by the setting segment</source>
        <translation>zwei Konturen sind gleich hoch: %1; welche gemeint ist, sagt das Fenster oder die Einstellung Segment</translation>
    </message>
    <message>
        <source>fewer than %1 contours end on that side in the window</source>
        <translation>weniger als %1 Konturen enden im Fenster auf dieser Seite</translation>
    </message>
    <message>
        <source>the contour leaves the sensor&apos;s field on that side at x = %1 mm: its end is not seen</source>
        <translation>die Kontur verlässt auf dieser Seite bei x = %1 mm das Feld des Sensors: ihr Ende ist nicht zu sehen</translation>
    </message>
    <message>
        <source>the contour runs under a higher one at x = %1 mm: its end on that side is not seen</source>
        <translation>die Kontur läuft bei x = %1 mm unter eine höhere: ihr Ende auf dieser Seite ist nicht zu sehen</translation>
    </message>
    <message>
        <source>%1 corners lie in the window: %2; say which by the window or by the setting which</source>
        <translation>%1 Ecken liegen im Fenster: %2; welche gemeint ist, sagt das Fenster oder die Einstellung „Welches“</translation>
    </message>
    <message>
        <source>a field from x = %1 to %2 mm is empty</source>
        <translation>ein Feld von x = %1 bis %2 mm ist leer</translation>
    </message>
    <message>
        <source>the contour runs on without a gap</source>
        <translation>die Kontur läuft ohne Spalt weiter</translation>
    </message>
    <message>
        <source>the frame holds neither a profile nor an image</source>
        <translation>die Aufnahme enthält weder ein Profil noch ein Bild</translation>
    </message>
    <message>
        <source>the points before the end do not form a line</source>
        <translation>die Punkte vor dem Ende bilden keine Gerade</translation>
    </message>
    <message>
        <source>the points do not form two lines</source>
        <translation>die Punkte bilden keine zwei Geraden</translation>
    </message>
    <message>
        <source>the sensor delivers images and its calibration holds no model</source>
        <translation>der Sensor liefert Bilder, und seine Kalibrierung enthält kein Modell</translation>
    </message>
    <message>
        <source>the sensor&apos;s own tool has found nothing</source>
        <translation>das Werkzeug des Sensors hat nichts gefunden</translation>
    </message>
    <message>
        <source>the template fits at two places about equally well</source>
        <translation>die Vorlage passt an zwei Stellen etwa gleich gut</translation>
    </message>
    <message>
        <source>the template is not in the profile, or not within the search window</source>
        <translation>die Vorlage ist nicht im Profil, oder nicht im Suchfenster</translation>
    </message>
    <message>
        <source>the template is seen in part only, and that has another shape: a reflection?</source>
        <translation>von der Vorlage ist nur ein Teil zu sehen, und der hat eine andere Form: eine Reflexion?</translation>
    </message>
    <message>
        <source>the two lines meet far away from the points</source>
        <translation>die beiden Geraden treffen sich weit weg von den Punkten</translation>
    </message>
    <message>
        <source>the two surfaces stand across each other: flush has no meaning</source>
        <translation>die beiden Flächen stehen quer zueinander: Bündigkeit hat keinen Sinn</translation>
    </message>
    <message>
        <source>too few points for the template</source>
        <translation>zu wenige Punkte für die Vorlage</translation>
    </message>
    <message>
        <source>too little straight surface beside an edge</source>
        <translation>zu wenig gerade Fläche neben einer Kante</translation>
    </message>
    <message>
        <source>no segment with %1 points in the window</source>
        <translation>kein Segment mit %1 Punkten im Fenster</translation>
    </message>
    <message>
        <source>no unbroken piece of %1 points in the window</source>
        <translation>kein ununterbrochenes Stück von %1 Punkten im Fenster</translation>
    </message>
    <message>
        <source>the radius of %1 mm is not within the limits</source>
        <translation>der Radius von %1 mm liegt nicht in den Grenzen</translation>
    </message>
    <message>
        <source>the two lines meet at %1 degrees only</source>
        <translation>die beiden Geraden treffen sich nur unter %1 Grad</translation>
    </message>
    <message>
        <source>what was found lies %1 mm beside the gap&apos;s course</source>
        <translation>was gefunden wurde, liegt %1 mm neben dem Verlauf des Spalts</translation>
    </message>
    <message>
        <source>%1 points in the window, a circle needs %2</source>
        <translation>%1 Punkte im Fenster, ein Kreis braucht %2</translation>
    </message>
    <message>
        <source>%1 points in the window, an extremum needs %2</source>
        <translation>%1 Punkte im Fenster, ein Extremum braucht %2</translation>
    </message>
    <message>
        <source>%1 points left and %2 right of the corner, each line needs %3</source>
        <translation>%1 Punkte links und %2 rechts der Ecke, jede Gerade braucht %3</translation>
    </message>
    <message>
        <source>%1 points within %2 mm of the extremum, the parabola needs %3</source>
        <translation>%1 Punkte innerhalb von %2 mm um das Extremum, die Parabel braucht %3</translation>
    </message>
    <message>
        <source>the feature is not a finite point</source>
        <translation>das Merkmal ist kein endlicher Punkt</translation>
    </message>
    <message>
        <source>the reported pose of the flange is no rigid pose</source>
        <translation>die gemeldete Pose des Flanschs ist keine starre Pose</translation>
    </message>
    <message>
        <source>the capture holds no profile</source>
        <translation>die Aufnahme enthält kein Profil</translation>
    </message>
    <message>
        <source>the sensor delivers %1 points, number %2 is meant</source>
        <translation>der Sensor liefert %1 Punkte, gemeint ist Nummer %2</translation>
    </message>
    <message>
        <source>%1 points in the window, a corner needs %2</source>
        <translation>%1 Punkte im Fenster, eine Ecke braucht %2</translation>
    </message>
    <message>
        <source>the arc of %1 degrees is too short: the centre is uncertain by %2 mm</source>
        <translation>der Bogen von %1 Grad ist zu kurz: die Mitte ist um %2 mm unsicher</translation>
    </message>
    <message>
        <source>sensor and robot of the simulated cell have different settings</source>
        <translation>Sensor und Roboter der simulierten Zelle haben verschiedene Einstellungen</translation>
    </message>
    <message>
        <source>give both the same settings</source>
        <translation>beiden dieselben Einstellungen geben</translation>
    </message>
    <message>
        <source>holds a vertex that is not finite</source>
        <translation>enthält eine Ecke, die nicht endlich ist</translation>
    </message>
    <message>
        <source>names a vertex that it does not hold</source>
        <translation>nennt eine Ecke, die sie nicht enthält</translation>
    </message>
    <message>
        <source>holds only degenerate triangles</source>
        <translation>enthält nur entartete Dreiecke</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no unit of a mesh</source>
        <translation>„%1“ ist keine Einheit eines Netzes</translation>
    </message>
    <message>
        <source>give &quot;mm&quot; or &quot;m&quot;</source>
        <translation>&quot;mm&quot; oder &quot;m&quot; angeben</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no scene</source>
        <translation>„%1“ ist keine Szene</translation>
    </message>
    <message>
        <source>give part, sphere, plate or triangle</source>
        <translation>part, sphere, plate oder triangle angeben</translation>
    </message>
    <message>
        <source>must be 8, 10, 12 or 16</source>
        <translation>muss 8, 10, 12 oder 16 sein</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no mode</source>
        <translation>„%1“ ist keine Betriebsart</translation>
    </message>
    <message>
        <source>give e.g. &quot;automatic&quot;</source>
        <translation>z. B. &quot;automatic&quot; angeben</translation>
    </message>
    <message>
        <source>all %1 frame buffers are in use</source>
        <translation>alle %1 Bildpuffer sind belegt</translation>
    </message>
    <message>
        <source>let go of frames that are no longer needed</source>
        <translation>nicht mehr benötigte Bilder freigeben</translation>
    </message>
    <message>
        <source>a capture has no parameter &quot;%1&quot;</source>
        <translation>eine Aufzeichnung hat keine Einstellung „%1“</translation>
    </message>
    <message>
        <source>the recording has not reached a pose</source>
        <translation>die Aufzeichnung hat noch keine Pose erreicht</translation>
    </message>
    <message>
        <source>the recording has no frame &quot;%1&quot;</source>
        <translation>die Aufzeichnung hat keinen Frame „%1“</translation>
    </message>
    <message>
        <source>give it in the robot&apos;s settings under &quot;frames&quot;</source>
        <translation>in den Einstellungen des Roboters unter &quot;frames&quot; angeben</translation>
    </message>
    <message>
        <source>a recording has no controller to write the frame &quot;%1&quot; to</source>
        <translation>eine Aufzeichnung hat keine Steuerung, auf die der Frame „%1“ zu schreiben wäre</translation>
    </message>
    <message>
        <source>set &quot;accept_frames&quot;: true to keep frames in memory</source>
        <translation>&quot;accept_frames&quot;: true setzen, um Frames im Speicher zu halten</translation>
    </message>
    <message>
        <source>must be 0 (as fast as frames are asked for) or 0.001 to 1000</source>
        <translation>muss 0 (so schnell, wie Bilder verlangt werden) oder 0.001 bis 1000 sein</translation>
    </message>
    <message>
        <source>the devices of one capture disagree</source>
        <translation>die Geräte einer Aufzeichnung widersprechen sich</translation>
    </message>
    <message>
        <source>set them alike</source>
        <translation>gleich einstellen</translation>
    </message>
    <message>
        <source>must be a whole number, 0 or more</source>
        <translation>muss eine ganze Zahl ab 0 sein</translation>
    </message>
    <message>
        <source>must be 2 to 4096</source>
        <translation>muss 2 bis 4096 sein</translation>
    </message>
    <message>
        <source>the capture has no %1</source>
        <translation>die Aufzeichnung hat keinen: %1</translation>
    </message>
    <message>
        <source>the capture has several %1s</source>
        <translation>die Aufzeichnung hat mehrere: %1</translation>
    </message>
    <message>
        <source>name one in settings.source: %1</source>
        <translation>einen in settings.source nennen: %1</translation>
    </message>
    <message>
        <source>the capture has no %1 &quot;%2&quot;</source>
        <translation>die Aufzeichnung hat nicht: %1 „%2“</translation>
    </message>
    <message>
        <source>two sensors play the same source &quot;%1&quot;</source>
        <translation>zwei Sensoren spielen dieselbe Quelle „%1“</translation>
    </message>
    <message>
        <source>give each a source of its own</source>
        <translation>jedem eine eigene Quelle geben</translation>
    </message>
    <message>
        <source>the source &quot;%1&quot; has %2 frames only</source>
        <translation>die Quelle „%1“ hat nur %2 Bilder</translation>
    </message>
    <message>
        <source>two robots play one capture</source>
        <translation>zwei Roboter spielen eine Aufzeichnung</translation>
    </message>
    <message>
        <source>the recording has no spot &quot;%1&quot;</source>
        <translation>die Aufzeichnung hat keine Messstelle „%1“</translation>
    </message>
    <message>
        <source>a measuring move names no spot</source>
        <translation>eine Messbewegung nennt keine Messstelle</translation>
    </message>
    <message>
        <source>must be the name of a file inside the folder</source>
        <translation>muss der Name einer Datei im Ordner sein</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is neither a profile (.csv) nor an image</source>
        <translation>„%1“ ist weder ein Profil (.csv) noch ein Bild</translation>
    </message>
    <message>
        <source>is empty</source>
        <translation>ist leer</translation>
    </message>
    <message>
        <source>names two poses</source>
        <translation>nennt zwei Posen</translation>
    </message>
    <message>
        <source>give base_from_flange or pose_file</source>
        <translation>base_from_flange oder pose_file angeben</translation>
    </message>
    <message>
        <source>is not the header file,spot_id[,pose_file]</source>
        <translation>ist nicht die Kopfzeile file,spot_id[,pose_file]</translation>
    </message>
    <message>
        <source>has %1 fields where the header names %2</source>
        <translation>hat %1 Felder, wo die Kopfzeile %2 nennt</translation>
    </message>
    <message>
        <source>holds more than %1 frames</source>
        <translation>enthält mehr als %1 Bilder</translation>
    </message>
    <message>
        <source>cannot be listed (%1)</source>
        <translation>kann nicht aufgelistet werden (%1)</translation>
    </message>
    <message>
        <source>holds both profiles (.csv) and images</source>
        <translation>enthält Profile (.csv) und Bilder</translation>
    </message>
    <message>
        <source>say which with the setting &quot;kind&quot;: &quot;profiles&quot; or &quot;images&quot;, or write a frames.csv</source>
        <translation>mit der Einstellung &quot;kind&quot;: &quot;profiles&quot; oder &quot;images&quot; sagen, welche, oder eine frames.csv schreiben</translation>
    </message>
    <message>
        <source>is no folder</source>
        <translation>ist kein Ordner</translation>
    </message>
    <message>
        <source>give the folder that holds the recorded frames</source>
        <translation>den Ordner mit den aufgezeichneten Bildern angeben</translation>
    </message>
    <message>
        <source>holds no frames</source>
        <translation>enthält keine Bilder</translation>
    </message>
    <message>
        <source>profiles are .csv, images .png, .bmp, .tiff or .pgm</source>
        <translation>Profile sind .csv, Bilder .png, .bmp, .tiff oder .pgm</translation>
    </message>
    <message>
        <source>has no pose</source>
        <translation>hat keine Pose</translation>
    </message>
    <message>
        <source>put its pose beside it, e.g. pose0001.txt for frame0001.png</source>
        <translation>seine Pose daneben legen, z. B. pose0001.txt zu frame0001.png</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no kind of frame</source>
        <translation>„%1“ ist keine Bildart</translation>
    </message>
    <message>
        <source>give &quot;profiles&quot; or &quot;images&quot;</source>
        <translation>&quot;profiles&quot; oder &quot;images&quot; angeben</translation>
    </message>
    <message>
        <source>sensor and robot of one recording disagree</source>
        <translation>Sensor und Roboter einer Aufzeichnung widersprechen sich</translation>
    </message>
    <message>
        <source>set both alike</source>
        <translation>beide gleich einstellen</translation>
    </message>
    <message>
        <source>the recording has no poses</source>
        <translation>die Aufzeichnung hat keine Posen</translation>
    </message>
    <message>
        <source>set require_poses to false</source>
        <translation>require_poses auf false setzen</translation>
    </message>
    <message>
        <source>the replay has no parameter &quot;%1&quot;</source>
        <translation>die Wiedergabe hat keine Einstellung „%1“</translation>
    </message>
    <message>
        <source>must be 0 to 10000</source>
        <translation>muss 0 bis 10000 sein</translation>
    </message>
    <message>
        <source>must be 0 (the file&apos;s own), 8, 10, 12 or 16</source>
        <translation>muss 0 (das der Datei), 8, 10, 12 oder 16 sein</translation>
    </message>
    <message>
        <source>the capture is damaged (%1)</source>
        <translation>die Aufzeichnung ist beschädigt (%1)</translation>
    </message>
    <message>
        <source>record it again, or take a copy from the backup</source>
        <translation>neu aufzeichnen oder eine Kopie aus der Sicherung nehmen</translation>
    </message>
    <message>
        <source>every source of a capture needs a name of its own</source>
        <translation>jede Quelle einer Aufzeichnung braucht einen eigenen Namen</translation>
    </message>
    <message>
        <source>this is a project, no recorded capture</source>
        <translation>dies ist ein Projekt, keine Aufzeichnung</translation>
    </message>
    <message>
        <source>choose the file that `seamwright record` wrote</source>
        <translation>die Datei wählen, die `seamwright record` geschrieben hat</translation>
    </message>
    <message>
        <source>this is another program&apos;s database, no capture</source>
        <translation>dies ist die Datenbank eines anderen Programms, keine Aufzeichnung</translation>
    </message>
    <message>
        <source>the capture has version %1, this program knows up to %2</source>
        <translation>die Aufzeichnung hat Version %1, dieses Programm kennt bis %2</translation>
    </message>
    <message>
        <source>open it with a newer Seamwright</source>
        <translation>mit einem neueren Seamwright öffnen</translation>
    </message>
    <message>
        <source>the capture has no valid version</source>
        <translation>die Aufzeichnung hat keine gültige Version</translation>
    </message>
    <message>
        <source>the block of frames is gone</source>
        <translation>der Block mit Bildern ist weg</translation>
    </message>
    <message>
        <source>the block of frames is not whole</source>
        <translation>der Block mit Bildern ist nicht ganz</translation>
    </message>
    <message>
        <source>the block of frames cannot be unpacked: the file is damaged</source>
        <translation>der Block mit Bildern lässt sich nicht auspacken: die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>the block holds another number of frames than it says</source>
        <translation>der Block enthält eine andere Zahl von Bildern, als er sagt</translation>
    </message>
    <message>
        <source>there is no frame %1</source>
        <translation>es gibt kein Bild %1</translation>
    </message>
    <message>
        <source>this is no block of profiles</source>
        <translation>dies ist kein Block von Profilen</translation>
    </message>
    <message>
        <source>the block of profiles has version %1, known is %2</source>
        <translation>der Block von Profilen hat Version %1, bekannt ist %2</translation>
    </message>
    <message>
        <source>this is another kind of block</source>
        <translation>dies ist ein Block anderer Art</translation>
    </message>
    <message>
        <source>the checksum of the profiles is wrong: the file is damaged</source>
        <translation>die Prüfsumme der Profile stimmt nicht: die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>the profile is not whole</source>
        <translation>das Profil ist nicht ganz</translation>
    </message>
    <message>
        <source>the capture does not fit the file&apos;s format (columns of different length, or too long)</source>
        <translation>die Aufnahme passt nicht in das Dateiformat (Spalten verschiedener Länge oder zu lang)</translation>
    </message>
    <message>
        <source>the block of profiles is not whole</source>
        <translation>der Block von Profilen ist nicht ganz</translation>
    </message>
    <message>
        <source>the frame does not fit the file&apos;s format (columns of different length, or too long)</source>
        <translation>das Bild passt nicht in das Dateiformat (Spalten verschiedener Länge oder zu lang)</translation>
    </message>
    <message>
        <source>must be 4 to 65536 MiB</source>
        <translation>muss 4 bis 65536 MiB sein</translation>
    </message>
    <message>
        <source>must be 10 to 10000 ms</source>
        <translation>muss 10 bis 10000 ms sein</translation>
    </message>
    <message>
        <source>this is no %1</source>
        <translation>dies ist nicht: %1</translation>
    </message>
    <message>
        <source>the %1 is damaged</source>
        <translation>%1: beschädigt</translation>
    </message>
    <message>
        <source>take the last good copy from the backup</source>
        <translation>die letzte gute Kopie aus der Sicherung nehmen</translation>
    </message>
    <message>
        <source>another program is writing to the %1</source>
        <translation>%1: ein anderes Programm schreibt gerade hinein</translation>
    </message>
    <message>
        <source>close it there and try again</source>
        <translation>dort schließen und noch einmal versuchen</translation>
    </message>
    <message>
        <source>the %1 cannot be written</source>
        <translation>%1: kann nicht geschrieben werden</translation>
    </message>
    <message>
        <source>check its permissions</source>
        <translation>seine Zugriffsrechte prüfen</translation>
    </message>
    <message>
        <source>the %1 cannot be opened</source>
        <translation>%1: kann nicht geöffnet werden</translation>
    </message>
    <message>
        <source>check name and permissions</source>
        <translation>Name und Zugriffsrechte prüfen</translation>
    </message>
    <message>
        <source>the disk is full</source>
        <translation>die Festplatte ist voll</translation>
    </message>
    <message>
        <source>make room and try again</source>
        <translation>Platz schaffen und noch einmal versuchen</translation>
    </message>
    <message>
        <source>the %1 needs more memory than there is</source>
        <translation>%1: braucht mehr Speicher, als da ist</translation>
    </message>
    <message>
        <source>a value is larger than a %1 holds (512 MiB)</source>
        <translation>ein Wert ist größer, als hineinpasst (512 MiB): %1</translation>
    </message>
    <message>
        <source>the %1 failed (%2)</source>
        <translation>%1: fehlgeschlagen (%2)</translation>
    </message>
    <message>
        <source>a column of the %1 holds a value of the wrong type</source>
        <translation>%1: eine Spalte enthält einen Wert falscher Art</translation>
    </message>
    <message>
        <source>a value is missing in the %1</source>
        <translation>%1: ein Wert fehlt</translation>
    </message>
    <message>
        <source>the %1 was replaced or deleted while it was in use</source>
        <translation>%1: im Gebrauch ersetzt oder gelöscht</translation>
    </message>
    <message>
        <source>close it and open what stands there now</source>
        <translation>schließen und öffnen, was jetzt dort steht</translation>
    </message>
    <message>
        <source>the checksum of an entry is wrong: the file is damaged</source>
        <translation>die Prüfsumme eines Eintrags ist falsch: die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>the entry is longer than %1 MiB</source>
        <translation>der Eintrag ist länger als %1 MiB</translation>
    </message>
    <message>
        <source>where the lock of the project belongs stands something else</source>
        <translation>wo die Sperre des Projekts hingehört, steht etwas anderes</translation>
    </message>
    <message>
        <source>move it away</source>
        <translation>dort wegnehmen</translation>
    </message>
    <message>
        <source>xyz contradicts the matrix</source>
        <translation>xyz widerspricht der Matrix</translation>
    </message>
    <message>
        <source>the JSON is longer than %1 MiB</source>
        <translation>das JSON ist länger als %1 MiB</translation>
    </message>
    <message>
        <source>the %1 is cut short</source>
        <translation>%1: abgeschnitten</translation>
    </message>
    <message>
        <source>cannot be opened (%1)</source>
        <translation>kann nicht geöffnet werden (%1)</translation>
    </message>
    <message>
        <source>is a folder, not a file</source>
        <translation>ist ein Ordner, keine Datei</translation>
    </message>
    <message>
        <source>is longer than %1 MiB</source>
        <translation>ist länger als %1 MiB</translation>
    </message>
    <message>
        <source>names no file</source>
        <translation>nennt keine Datei</translation>
    </message>
    <message>
        <source>give the path of a file</source>
        <translation>den Pfad einer Datei angeben</translation>
    </message>
    <message>
        <source>cannot be written (%1)</source>
        <translation>kann nicht geschrieben werden (%1)</translation>
    </message>
    <message>
        <source>check that the folder exists and is writable</source>
        <translation>prüfen, ob es den Ordner gibt und er beschreibbar ist</translation>
    </message>
    <message>
        <source>a bit depth of %1 is not supported</source>
        <translation>eine Bittiefe von %1 wird nicht unterstützt</translation>
    </message>
    <message>
        <source>give 8, 10, 12 or 16</source>
        <translation>8, 10, 12 oder 16 angeben</translation>
    </message>
    <message>
        <source>the image file is empty</source>
        <translation>die Bilddatei ist leer</translation>
    </message>
    <message>
        <source>is no readable image</source>
        <translation>ist kein lesbares Bild</translation>
    </message>
    <message>
        <source>give PNG, BMP, TIFF or PGM</source>
        <translation>PNG, BMP, TIFF oder PGM angeben</translation>
    </message>
    <message>
        <source>the JPEG image is truncated</source>
        <translation>das JPEG-Bild ist abgeschnitten</translation>
    </message>
    <message>
        <source>the image has neither 8 nor 16 bit</source>
        <translation>das Bild hat weder 8 noch 16 Bit</translation>
    </message>
    <message>
        <source>the image is too large</source>
        <translation>das Bild ist zu groß</translation>
    </message>
    <message>
        <source>the image is neither grey nor colour</source>
        <translation>das Bild ist weder grau noch farbig</translation>
    </message>
    <message>
        <source>the image does not have %1 bit</source>
        <translation>das Bild hat nicht %1 Bit</translation>
    </message>
    <message>
        <source>the value %1 does not fit %2 bit</source>
        <translation>der Wert %1 passt nicht in %2 Bit</translation>
    </message>
    <message>
        <source>there is no image to write</source>
        <translation>es gibt kein Bild zu schreiben</translation>
    </message>
    <message>
        <source>the image cannot be encoded</source>
        <translation>das Bild lässt sich nicht kodieren</translation>
    </message>
    <message>
        <source>name it .png, .tiff or .pgm</source>
        <translation>es .png, .tiff oder .pgm nennen</translation>
    </message>
    <message>
        <source>the JSON is nested deeper than %1</source>
        <translation>das JSON ist tiefer geschachtelt als %1</translation>
    </message>
    <message>
        <source>the key &quot;%1&quot; is given twice in one object</source>
        <translation>der Schlüssel „%1“ steht zweimal in einem Objekt</translation>
    </message>
    <message>
        <source>is no JSON (%1)</source>
        <translation>ist kein JSON (%1)</translation>
    </message>
    <message>
        <source>must be an object, not %1</source>
        <translation>muss ein Objekt sein, nicht %1</translation>
    </message>
    <message>
        <source>is not a known field</source>
        <translation>ist kein bekanntes Feld</translation>
    </message>
    <message>
        <source>%1 is given under its former name too</source>
        <translation>%1 steht auch unter dem früheren Namen da</translation>
    </message>
    <message>
        <source>must be a number, not %1</source>
        <translation>muss eine Zahl sein, nicht %1</translation>
    </message>
    <message>
        <source>must be finite</source>
        <translation>muss endlich sein</translation>
    </message>
    <message>
        <source>is missing</source>
        <translation>fehlt</translation>
    </message>
    <message>
        <source>must be an array, not %1</source>
        <translation>muss eine Liste sein, nicht %1</translation>
    </message>
    <message>
        <source>must be a text, not %1</source>
        <translation>muss ein Text sein, nicht %1</translation>
    </message>
    <message>
        <source>must be true or false, not %1</source>
        <translation>muss true oder false sein, nicht %1</translation>
    </message>
    <message>
        <source>must be an array of numbers, not %1</source>
        <translation>muss eine Liste von Zahlen sein, nicht %1</translation>
    </message>
    <message>
        <source>has %1 entries instead of %2</source>
        <translation>hat %1 Einträge statt %2</translation>
    </message>
    <message>
        <source>a table of %1x%2 nodes is not possible</source>
        <translation>eine Tabelle mit %1x%2 Knoten ist nicht möglich</translation>
    </message>
    <message>
        <source>2x2 to 16 million nodes in all</source>
        <translation>2x2 bis zu 16 Millionen Knoten insgesamt</translation>
    </message>
    <message>
        <source>the table&apos;s grid is not made of finite numbers with steps above 0</source>
        <translation>das Gitter der Tabelle besteht nicht aus endlichen Zahlen mit Schritten über 0</translation>
    </message>
    <message>
        <source>the table holds %1 and %2 numbers for %3 nodes</source>
        <translation>die Tabelle enthält %1 und %2 Zahlen für %3 Knoten</translation>
    </message>
    <message>
        <source>node %1 is infinite</source>
        <translation>Knoten %1 ist unendlich</translation>
    </message>
    <message>
        <source>node %1 is half a hole: only one of x and z is a number</source>
        <translation>Knoten %1 ist ein halbes Loch: nur eines von x und z ist eine Zahl</translation>
    </message>
    <message>
        <source>this is no look-up table: its first line is missing</source>
        <translation>dies ist keine Nachschlagetabelle: ihre erste Zeile fehlt</translation>
    </message>
    <message>
        <source>give a file that calibrate lut has written</source>
        <translation>eine Datei angeben, die calibrate lut geschrieben hat</translation>
    </message>
    <message>
        <source>this is no look-up table but &apos;%1&apos;</source>
        <translation>dies ist keine Nachschlagetabelle, sondern „%1“</translation>
    </message>
    <message>
        <source>version %1 of the look-up table is not known</source>
        <translation>Version %1 der Nachschlagetabelle ist nicht bekannt</translation>
    </message>
    <message>
        <source>version 1 can be read</source>
        <translation>Version 1 kann gelesen werden</translation>
    </message>
    <message>
        <source>the table has more than 16 million nodes</source>
        <translation>die Tabelle hat mehr als 16 Millionen Knoten</translation>
    </message>
    <message>
        <source>the file has %1 bytes instead of %2</source>
        <translation>die Datei hat %1 Bytes statt %2</translation>
    </message>
    <message>
        <source>it was cut off or added to: take the original</source>
        <translation>sie wurde abgeschnitten oder verlängert: das Original nehmen</translation>
    </message>
    <message>
        <source>the check sum does not fit: the file is damaged</source>
        <translation>die Prüfsumme stimmt nicht: die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>take the original</source>
        <translation>das Original nehmen</translation>
    </message>
    <message>
        <source>the text is UTF-16</source>
        <translation>der Text ist UTF-16</translation>
    </message>
    <message>
        <source>save it as UTF-8 or plain ASCII</source>
        <translation>als UTF-8 oder reines ASCII speichern</translation>
    </message>
    <message>
        <source>the first line must be %1</source>
        <translation>die erste Zeile muss %1 sein</translation>
    </message>
    <message>
        <source>the columns are separated by %1</source>
        <translation>die Spalten sind getrennt durch %1</translation>
    </message>
    <message>
        <source>separate them by commas and write decimal points, not decimal commas</source>
        <translation>durch Kommas trennen und Dezimalpunkte schreiben, keine Dezimalkommas</translation>
    </message>
    <message>
        <source>the column %1 is named twice</source>
        <translation>die Spalte %1 ist zweimal genannt</translation>
    </message>
    <message>
        <source>the header &quot;%1&quot; has no column %2</source>
        <translation>die Kopfzeile „%1“ hat keine Spalte %2</translation>
    </message>
    <message>
        <source>the line is blank</source>
        <translation>die Zeile ist leer</translation>
    </message>
    <message>
        <source>a point without return is a line with empty fields</source>
        <translation>ein Punkt ohne Rückgabe ist eine Zeile mit leeren Feldern</translation>
    </message>
    <message>
        <source>%1 = &quot;%2&quot; does not fit a number</source>
        <translation>%1 = „%2“ passt in keine Zahl</translation>
    </message>
    <message>
        <source>%1 = &quot;%2&quot; is no number</source>
        <translation>%1 = „%2“ ist keine Zahl</translation>
    </message>
    <message>
        <source>separate the columns by commas and write decimal points</source>
        <translation>Spalten durch Kommas trennen und Dezimalpunkte schreiben</translation>
    </message>
    <message>
        <source>%1 is infinite</source>
        <translation>%1 ist unendlich</translation>
    </message>
    <message>
        <source>%1 = %2 mm is beyond 1 km</source>
        <translation>%1 = %2 mm liegt über 1 km</translation>
    </message>
    <message>
        <source>has %1 rows instead of 4</source>
        <translation>hat %1 Zeilen statt 4</translation>
    </message>
    <message>
        <source>an angle exceeds 720</source>
        <translation>ein Winkel übersteigt 720</translation>
    </message>
    <message>
        <source>give degrees</source>
        <translation>Grad angeben</translation>
    </message>
    <message>
        <source>a number is not finite</source>
        <translation>eine Zahl ist nicht endlich</translation>
    </message>
    <message>
        <source>the translation is %1 m long, but this format is in metres</source>
        <translation>die Verschiebung ist %1 m lang, dieses Format ist aber in Metern</translation>
    </message>
    <message>
        <source>convert millimetres to metres or use a .json pose file</source>
        <translation>Millimeter in Meter umrechnen oder eine .json-Posendatei verwenden</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no number</source>
        <translation>„%1“ ist keine Zahl</translation>
    </message>
    <message>
        <source>mixes several forms of a pose</source>
        <translation>mischt mehrere Schreibweisen einer Pose</translation>
    </message>
    <message>
        <source>give xyz with one of abc, quat_wxyz, rotvec_rad, or matrix alone</source>
        <translation>xyz mit einem von abc, quat_wxyz, rotvec_rad angeben, oder nur matrix</translation>
    </message>
    <message>
        <source>has no rotation</source>
        <translation>hat keine Drehung</translation>
    </message>
    <message>
        <source>has no translation</source>
        <translation>hat keine Verschiebung</translation>
    </message>
    <message>
        <source>the translation exceeds 100 m</source>
        <translation>die Verschiebung übersteigt 100 m</translation>
    </message>
    <message>
        <source>xyz and abc contradict matrix</source>
        <translation>xyz und abc widersprechen matrix</translation>
    </message>
    <message>
        <source>give one form only</source>
        <translation>nur eine Schreibweise angeben</translation>
    </message>
    <message>
        <source>the rotation vector is longer than one turn</source>
        <translation>der Drehvektor ist länger als eine Umdrehung</translation>
    </message>
    <message>
        <source>give radian</source>
        <translation>Radiant angeben</translation>
    </message>
    <message>
        <source>holds more than 7 numbers</source>
        <translation>enthält mehr als 7 Zahlen</translation>
    </message>
    <message>
        <source>write ((x, y, z), (qx, qy, qz, qw))</source>
        <translation>((x, y, z), (qx, qy, qz, qw)) schreiben</translation>
    </message>
    <message>
        <source>holds %1 numbers instead of 7</source>
        <translation>enthält %1 Zahlen statt 7</translation>
    </message>
    <message>
        <source>write ((x, y, z), (qx, qy, qz, qw)) in metres</source>
        <translation>((x, y, z), (qx, qy, qz, qw)) in Metern schreiben</translation>
    </message>
    <message>
        <source>is no `key: number`</source>
        <translation>ist kein `Schlüssel: Zahl`</translation>
    </message>
    <message>
        <source>is not one of x, y, z, qx, qy, qz, qw</source>
        <translation>ist keines von x, y, z, qx, qy, qz, qw</translation>
    </message>
    <message>
        <source>%1 is given twice</source>
        <translation>%1 ist zweimal angegeben</translation>
    </message>
    <message>
        <source>%1 is missing</source>
        <translation>%1 fehlt</translation>
    </message>
    <message>
        <source>is no known kind of pose file</source>
        <translation>ist keine bekannte Art einer Posendatei</translation>
    </message>
    <message>
        <source>known are .txt, .yaml and .json</source>
        <translation>bekannt sind .txt, .yaml und .json</translation>
    </message>
    <message>
        <source>there are more than %1 points</source>
        <translation>es sind mehr als %1 Punkte</translation>
    </message>
    <message>
        <source>valid must be 0 or 1</source>
        <translation>valid muss 0 oder 1 sein</translation>
    </message>
    <message>
        <source>segment must be a whole number from -1 on</source>
        <translation>segment muss eine ganze Zahl ab -1 sein</translation>
    </message>
    <message>
        <source>valid = %1 contradicts segment = %2</source>
        <translation>valid = %1 widerspricht segment = %2</translation>
    </message>
    <message>
        <source>a point without return cannot belong to a segment</source>
        <translation>ein Punkt ohne Rückgabe kann zu keinem Segment gehören</translation>
    </message>
    <message>
        <source>a point without return cannot be valid</source>
        <translation>ein Punkt ohne Rückgabe kann nicht gültig sein</translation>
    </message>
    <message>
        <source>the profile has no points</source>
        <translation>das Profil hat keine Punkte</translation>
    </message>
    <message>
        <source>travel_mm is missing</source>
        <translation>travel_mm fehlt</translation>
    </message>
    <message>
        <source>profile_index must be a whole number from 0 on</source>
        <translation>profile_index muss eine ganze Zahl ab 0 sein</translation>
    </message>
    <message>
        <source>profile %1 comes back after another one</source>
        <translation>Profil %1 kommt nach einem anderen noch einmal</translation>
    </message>
    <message>
        <source>keep the rows of a profile together</source>
        <translation>die Zeilen eines Profils zusammenhalten</translation>
    </message>
    <message>
        <source>travel_mm changes within profile %1</source>
        <translation>travel_mm ändert sich innerhalb von Profil %1</translation>
    </message>
    <message>
        <source>%1 is not known</source>
        <translation>%1: nicht bekannt</translation>
    </message>
    <message>
        <source>calibrate camera and laser plane first</source>
        <translation>zuerst Kamera und Laserebene kalibrieren</translation>
    </message>
    <message>
        <source>the solution is undetermined: %1</source>
        <translation>die Lösung ist unterbestimmt: %1</translation>
    </message>
    <message>
        <source>the frames give no laser plane</source>
        <translation>die Bilder ergeben keine Laserebene</translation>
    </message>
    <message>
        <source>the camera does not ride on the flange</source>
        <translation>die Kamera fährt nicht auf dem Flansch mit</translation>
    </message>
    <message>
        <source>a sensor beside the robot is kept as a record</source>
        <translation>ein Sensor neben dem Roboter wird als Nachweis aufbewahrt</translation>
    </message>
    <message>
        <source>there is no solution yet</source>
        <translation>es gibt noch keine Lösung</translation>
    </message>
    <message>
        <source>solve first</source>
        <translation>zuerst lösen</translation>
    </message>
    <message>
        <source>the project has no such sensor</source>
        <translation>das Projekt hat diesen Sensor nicht</translation>
    </message>
    <message>
        <source>the project does not know the sensors of these chains: %1</source>
        <translation>das Projekt kennt die Sensoren dieser Ketten nicht: %1</translation>
    </message>
    <message>
        <source>take their ticks away, or name the sensors in the data as in the project</source>
        <translation>ihre Haken wegnehmen oder die Sensoren in den Daten wie im Projekt nennen</translation>
    </message>
    <message>
        <source>give each sensor one chain</source>
        <translation>jedem Sensor eine Kette geben</translation>
    </message>
    <message>
        <source>the chain ends in the world, not on the flange</source>
        <translation>die Kette endet in der Welt, nicht am Flansch</translation>
    </message>
    <message>
        <source>give reference_from_world with the flange as reference</source>
        <translation>reference_from_world mit dem Flansch als Bezug angeben</translation>
    </message>
    <message>
        <source>how far the body has moved is not known</source>
        <translation>wie weit der Körper sich bewegt hat, ist nicht bekannt</translation>
    </message>
    <message>
        <source>connect the robot that shifts the sensor, or load measured pairs</source>
        <translation>den Roboter verbinden, der den Sensor verschiebt, oder gemessene Paare laden</translation>
    </message>
    <message>
        <source>where the sensor sits on the flange is not known</source>
        <translation>wo der Sensor am Flansch sitzt, ist nicht bekannt</translation>
    </message>
    <message>
        <source>calibrate the sensor on the flange first, or load measured pairs</source>
        <translation>zuerst den Sensor am Flansch kalibrieren oder gemessene Paare laden</translation>
    </message>
    <message>
        <source>the sensor was turned by %1 degrees since the first capture</source>
        <translation>der Sensor wurde seit der ersten Aufnahme um %1 Grad gedreht</translation>
    </message>
    <message>
        <source>only shift it, along its own X and Z</source>
        <translation>nur verschieben, entlang seines X und Z</translation>
    </message>
    <message>
        <source>the sensor was shifted by %1 mm along its Y</source>
        <translation>der Sensor wurde um %1 mm entlang seines Y verschoben</translation>
    </message>
    <message>
        <source>only shift it along its own X and Z</source>
        <translation>nur entlang seines X und Z verschieben</translation>
    </message>
    <message>
        <source>a focal length must be positive</source>
        <translation>eine Brennweite muss positiv sein</translation>
    </message>
    <message>
        <source>give fx and fy in pixels</source>
        <translation>fx und fy in Pixeln angeben</translation>
    </message>
    <message>
        <source>the data is not a JSON object</source>
        <translation>die Daten sind kein JSON-Objekt</translation>
    </message>
    <message>
        <source>see calibrate camera --help</source>
        <translation>siehe calibrate camera --help</translation>
    </message>
    <message>
        <source>this is no image size</source>
        <translation>dies ist keine Bildgröße</translation>
    </message>
    <message>
        <source>the image cannot be read: %1</source>
        <translation>das Bild kann nicht gelesen werden: %1</translation>
    </message>
    <message>
        <source>exclude it with --exclude %1</source>
        <translation>mit --exclude %1 ausschließen</translation>
    </message>
    <message>
        <source>the images have different sizes</source>
        <translation>die Bilder sind verschieden groß</translation>
    </message>
    <message>
        <source>give images of one camera at one resolution</source>
        <translation>Bilder einer Kamera mit einer Auflösung angeben</translation>
    </message>
    <message>
        <source>no board of %1 points was found in any of %2 images</source>
        <translation>in keinem von %2 Bildern wurde eine Tafel mit %1 Punkten gefunden</translation>
    </message>
    <message>
        <source>check --board, --pattern, light and focus</source>
        <translation>--board, --pattern, Licht und Schärfe prüfen</translation>
    </message>
    <message>
        <source>bring the stripe onto the sphere</source>
        <translation>den Laserstreifen auf die Kugel bringen</translation>
    </message>
    <message>
        <source>no circle of the sphere is seen in the profile</source>
        <translation>im Profil ist kein Kreis der Kugel zu sehen</translation>
    </message>
    <message>
        <source>bring the stripe onto the sphere, a little off its middle, and check its radius</source>
        <translation>den Laserstreifen auf die Kugel bringen, etwas neben ihre Mitte, und ihren Radius prüfen</translation>
    </message>
    <message>
        <source>the camera is not known</source>
        <translation>die Kamera ist nicht bekannt</translation>
    </message>
    <message>
        <source>the robot&apos;s pose is missing</source>
        <translation>die Pose des Roboters fehlt</translation>
    </message>
    <message>
        <source>connect the robot, or put its pose file beside the image</source>
        <translation>den Roboter verbinden oder seine Posendatei neben das Bild legen</translation>
    </message>
    <message>
        <source>where the camera sits on the flange is not known</source>
        <translation>wo die Kamera am Flansch sitzt, ist nicht bekannt</translation>
    </message>
    <message>
        <source>calibrate hand-eye or with the sphere first, or load measured points</source>
        <translation>zuerst Hand-Auge oder mit der Kugel kalibrieren oder gemessene Punkte laden</translation>
    </message>
    <message>
        <source>where the plate stands is not known</source>
        <translation>wo die Platte steht, ist nicht bekannt</translation>
    </message>
    <message>
        <source>find it with &quot;Plate in the world&quot; first, or load the chain</source>
        <translation>sie zuerst mit „Platte in der Welt“ finden oder die Kette laden</translation>
    </message>
    <message>
        <source>the robot has moved since the first shot</source>
        <translation>der Roboter hat sich seit der ersten Aufnahme bewegt</translation>
    </message>
    <message>
        <source>one shot is enough: begin anew to take another from here</source>
        <translation>eine Aufnahme genügt: neu beginnen, um von hier eine andere zu machen</translation>
    </message>
    <message>
        <source>the image has another size than those before</source>
        <translation>das Bild hat eine andere Größe als die davor</translation>
    </message>
    <message>
        <source>use one camera at one resolution</source>
        <translation>eine Kamera mit einer Auflösung verwenden</translation>
    </message>
    <message>
        <source>only %1 points of the stripe lie on one line</source>
        <translation>nur %1 Punkte des Streifens liegen auf einer Geraden</translation>
    </message>
    <message>
        <source>hold the sensor over a flat plate that fills the view</source>
        <translation>den Sensor über eine ebene Platte halten, die das Messfeld füllt</translation>
    </message>
    <message>
        <source>there is no calibration in use to check</source>
        <translation>es ist keine Kalibrierung in Gebrauch, die zu prüfen wäre</translation>
    </message>
    <message>
        <source>calibrate first</source>
        <translation>zuerst kalibrieren</translation>
    </message>
    <message>
        <source>where the sphere stands is not known</source>
        <translation>wo die Kugel steht, ist nicht bekannt</translation>
    </message>
    <message>
        <source>check a calibration that was made with the sphere, or load measured data</source>
        <translation>eine mit der Kugel gemachte Kalibrierung prüfen oder gemessene Daten laden</translation>
    </message>
    <message>
        <source>the frame is incomplete</source>
        <translation>das Bild ist unvollständig</translation>
    </message>
    <message>
        <source>the frame is corrupt</source>
        <translation>das Bild ist beschädigt</translation>
    </message>
    <message>
        <source>the frame is late</source>
        <translation>das Bild kam zu spät</translation>
    </message>
    <message>
        <source>take it again</source>
        <translation>noch einmal aufnehmen</translation>
    </message>
    <message>
        <source>the sensor gives no image</source>
        <translation>der Sensor liefert kein Bild</translation>
    </message>
    <message>
        <source>switch its raw image on</source>
        <translation>sein Rohbild einschalten</translation>
    </message>
    <message>
        <source>the robot does not tell its pose</source>
        <translation>der Roboter sagt seine Pose nicht</translation>
    </message>
    <message>
        <source>connect the robot</source>
        <translation>den Roboter verbinden</translation>
    </message>
    <message>
        <source>the data of this method are loaded from a file</source>
        <translation>die Daten dieses Verfahrens werden aus einer Datei geladen</translation>
    </message>
    <message>
        <source>this method reads no images</source>
        <translation>dieses Verfahren liest keine Bilder</translation>
    </message>
    <message>
        <source>give its JSON file</source>
        <translation>seine JSON-Datei angeben</translation>
    </message>
    <message>
        <source>nothing was read</source>
        <translation>nichts wurde gelesen</translation>
    </message>
    <message>
        <source>a sigma is negative</source>
        <translation>ein Sigma ist negativ</translation>
    </message>
    <message>
        <source>the sigma is not positive</source>
        <translation>das Sigma ist nicht positiv</translation>
    </message>
    <message>
        <source>see calibrate drift --help</source>
        <translation>siehe calibrate drift --help</translation>
    </message>
    <message>
        <source>see calibrate hand-eye --help</source>
        <translation>siehe calibrate hand-eye --help</translation>
    </message>
    <message>
        <source>the mount &apos;%1&apos; is unknown</source>
        <translation>die Anordnung „%1“ ist unbekannt</translation>
    </message>
    <message>
        <source>write eye_in_hand or eye_to_hand</source>
        <translation>eye_in_hand oder eye_to_hand schreiben</translation>
    </message>
    <message>
        <source>see calibrate laser-plane --help</source>
        <translation>siehe calibrate laser-plane --help</translation>
    </message>
    <message>
        <source>see calibrate lens --help</source>
        <translation>siehe calibrate lens --help</translation>
    </message>
    <message>
        <source>this is not a list of points</source>
        <translation>dies ist keine Liste von Punkten</translation>
    </message>
    <message>
        <source>write [[u,v],..]</source>
        <translation>[[u,v],..] schreiben</translation>
    </message>
    <message>
        <source>&apos;%1&apos; is no line number</source>
        <translation>„%1“ ist keine Liniennummer</translation>
    </message>
    <message>
        <source>see calibrate lut --help</source>
        <translation>siehe calibrate lut --help</translation>
    </message>
    <message>
        <source>the step is not above 0</source>
        <translation>der Schritt ist nicht über 0</translation>
    </message>
    <message>
        <source>there is no setting &quot;%1&quot;</source>
        <translation>es gibt keine Einstellung „%1“</translation>
    </message>
    <message>
        <source>see calibrate plate --help</source>
        <translation>siehe calibrate plate --help</translation>
    </message>
    <message>
        <source>there is no point</source>
        <translation>es gibt keinen Punkt</translation>
    </message>
    <message>
        <source>&apos;%1&apos; is no board</source>
        <translation>„%1“ ist keine Tafel</translation>
    </message>
    <message>
        <source>write columns x rows, e.g. 7x6</source>
        <translation>Spalten x Zeilen schreiben, z. B. 7x6</translation>
    </message>
    <message>
        <source>the pattern &apos;%1&apos; is unknown</source>
        <translation>das Muster „%1“ ist unbekannt</translation>
    </message>
    <message>
        <source>write chessboard, circles or charuco</source>
        <translation>chessboard, circles oder charuco schreiben</translation>
    </message>
    <message>
        <source>this is no folder</source>
        <translation>dies ist kein Ordner</translation>
    </message>
    <message>
        <source>give a folder of images</source>
        <translation>einen Ordner mit Bildern angeben</translation>
    </message>
    <message>
        <source>two images are named &apos;%1&apos;</source>
        <translation>zwei Bilder heißen „%1“</translation>
    </message>
    <message>
        <source>keep one of them</source>
        <translation>eines davon behalten</translation>
    </message>
    <message>
        <source>the folder cannot be read: %1</source>
        <translation>der Ordner kann nicht gelesen werden: %1</translation>
    </message>
    <message>
        <source>there is no image in the folder</source>
        <translation>im Ordner ist kein Bild</translation>
    </message>
    <message>
        <source>give a folder of PNG, TIFF, PGM, BMP or JPEG images</source>
        <translation>einen Ordner mit PNG-, TIFF-, PGM-, BMP- oder JPEG-Bildern angeben</translation>
    </message>
    <message>
        <source>there is no image &apos;%1&apos; to exclude</source>
        <translation>es gibt kein Bild „%1“, das auszuschließen wäre</translation>
    </message>
    <message>
        <source>name images without their extension</source>
        <translation>Bilder ohne ihre Endung nennen</translation>
    </message>
    <message>
        <source>this is not an object</source>
        <translation>dies ist kein Objekt</translation>
    </message>
    <message>
        <source>the id is neither text nor number</source>
        <translation>die Kennung ist weder Text noch Zahl</translation>
    </message>
    <message>
        <source>the folder cannot be made: %1</source>
        <translation>der Ordner kann nicht angelegt werden: %1</translation>
    </message>
    <message>
        <source>the folder cannot be moved: %1</source>
        <translation>der Ordner kann nicht verschoben werden: %1</translation>
    </message>
    <message>
        <source>the calibration sessions cannot be copied: %1</source>
        <translation>die Kalibriersitzungen können nicht kopiert werden: %1</translation>
    </message>
    <message>
        <source>the calibration method &apos;%1&apos; is unknown</source>
        <translation>das Kalibrierverfahren „%1“ ist unbekannt</translation>
    </message>
    <message>
        <source>this is no calibration session of %1</source>
        <translation>dies ist keine Kalibriersitzung von %1</translation>
    </message>
    <message>
        <source>a newer Seamwright has written this session</source>
        <translation>ein neueres Seamwright hat diese Sitzung geschrieben</translation>
    </message>
    <message>
        <source>use that one</source>
        <translation>jenes verwenden</translation>
    </message>
    <message>
        <source>there is no capture %1</source>
        <translation>es gibt keine Aufnahme %1</translation>
    </message>
    <message>
        <source>%1 captures are too few, at least %2 are needed</source>
        <translation>%1 Aufnahmen sind zu wenige, mindestens %2 sind nötig</translation>
    </message>
    <message>
        <source>take more</source>
        <translation>mehr aufnehmen</translation>
    </message>
    <message>
        <source>covariance and sigma are both given</source>
        <translation>Kovarianz und Sigma sind beide angegeben</translation>
    </message>
    <message>
        <source>give one of them</source>
        <translation>eines davon angeben</translation>
    </message>
    <message>
        <source>the covariance has not six rows</source>
        <translation>die Kovarianz hat nicht sechs Zeilen</translation>
    </message>
    <message>
        <source>plate_from_camera and camera_from_plate are both given</source>
        <translation>plate_from_camera und camera_from_plate sind beide angegeben</translation>
    </message>
    <message>
        <source>see calibrate static --help</source>
        <translation>siehe calibrate static --help</translation>
    </message>
    <message>
        <source>this is no corner of the board</source>
        <translation>dies ist keine Ecke der Tafel</translation>
    </message>
    <message>
        <source>pixel and index have different lengths</source>
        <translation>pixel und index sind verschieden lang</translation>
    </message>
    <message>
        <source>the scan &apos;%1&apos; is unknown</source>
        <translation>die Abtastung „%1“ ist unbekannt</translation>
    </message>
    <message>
        <source>write rows or columns</source>
        <translation>rows oder columns schreiben</translation>
    </message>
    <message>
        <source>this is no count</source>
        <translation>dies ist keine Anzahl</translation>
    </message>
    <message>
        <source>see calibrate stripe-camera --help</source>
        <translation>siehe calibrate stripe-camera --help</translation>
    </message>
    <message>
        <source>a point is not [x, z]</source>
        <translation>ein Punkt ist nicht [x, z]</translation>
    </message>
    <message>
        <source>write two numbers, null for no return</source>
        <translation>zwei Zahlen schreiben, null für keine Rückgabe</translation>
    </message>
    <message>
        <source>a coordinate is no number</source>
        <translation>eine Koordinate ist keine Zahl</translation>
    </message>
    <message>
        <source>see calibrate tcp-sphere --help</source>
        <translation>siehe calibrate tcp-sphere --help</translation>
    </message>
    <message>
        <source>the sphere&apos;s radius is missing</source>
        <translation>der Radius der Kugel fehlt</translation>
    </message>
    <message>
        <source>give it in millimetres, or null to solve for it</source>
        <translation>in Millimetern angeben, oder null, um ihn mitzulösen</translation>
    </message>
    <message>
        <source>the frame is of spot %1</source>
        <translation>das Bild gehört zu Messstelle %1</translation>
    </message>
    <message>
        <source>frame %1 came where frame %2 was due</source>
        <translation>Bild %1 kam, wo Bild %2 an der Reihe war</translation>
    </message>
    <message>
        <source>the sensor restarted in the middle of the run; measure again</source>
        <translation>der Sensor ist mitten im Lauf neu gestartet; noch einmal messen</translation>
    </message>
    <message>
        <source>frame %1 came %2 s before the trigger of spot %3</source>
        <translation>Bild %1 kam %2 s vor dem Trigger von Messstelle %3</translation>
    </message>
    <message>
        <source>frame %1 came %2 s after the trigger of spot %3</source>
        <translation>Bild %1 kam %2 s nach dem Trigger von Messstelle %3</translation>
    </message>
    <message>
        <source>this is no exported project</source>
        <translation>dies ist kein exportiertes Projekt</translation>
    </message>
    <message>
        <source>give what `seamwright export` wrote</source>
        <translation>angeben, was `seamwright export` geschrieben hat</translation>
    </message>
    <message>
        <source>the export has no version</source>
        <translation>der Export hat keine Version</translation>
    </message>
    <message>
        <source>the export is newer than this program (version %1)</source>
        <translation>der Export ist neuer als dieses Programm (Version %1)</translation>
    </message>
    <message>
        <source>import it with a newer Seamwright</source>
        <translation>mit einem neueren Seamwright importieren</translation>
    </message>
    <message>
        <source>the folder cannot be made</source>
        <translation>der Ordner kann nicht angelegt werden</translation>
    </message>
    <message>
        <source>check its name and permissions</source>
        <translation>Name und Zugriffsrechte prüfen</translation>
    </message>
    <message>
        <source>nothing is written to a robot whose base is shifted for a proof</source>
        <translation>einem Roboter, dessen Basis für einen Nachweis verschoben ist, wird nichts geschrieben</translation>
    </message>
    <message>
        <source>no region has a calibrated spot</source>
        <translation>kein Korrekturbereich hat eine kalibrierte Messstelle</translation>
    </message>
    <message>
        <source>teach spots and make a region first</source>
        <translation>zuerst Messstellen einlernen und einen Korrekturbereich anlegen</translation>
    </message>
    <message>
        <source>nobody is there to displace the part</source>
        <translation>niemand ist da, um das Teil zu verschieben</translation>
    </message>
    <message>
        <source>run it at a terminal</source>
        <translation>an einem Terminal ausführen</translation>
    </message>
    <message>
        <source>only a simulated cell can move its part</source>
        <translation>nur eine simulierte Zelle kann ihr Teil bewegen</translation>
    </message>
    <message>
        <source>shift the robot&apos;s base instead</source>
        <translation>stattdessen die Basis des Roboters verschieben</translation>
    </message>
    <message>
        <source>a range of %1 %2 in steps of %3 %4</source>
        <translation>ein Bereich von %1 %2 in Schritten von %3 %4</translation>
    </message>
    <message>
        <source>give a positive range and a step not above it</source>
        <translation>einen positiven Bereich und einen Schritt nicht darüber angeben</translation>
    </message>
    <message>
        <source>%1 displacements are too many</source>
        <translation>%1 Verschiebungen sind zu viele</translation>
    </message>
    <message>
        <source>give larger steps</source>
        <translation>größere Schritte angeben</translation>
    </message>
    <message>
        <source>cancelled after %1 of %2 displacements</source>
        <translation>abgebrochen nach %1 von %2 Verschiebungen</translation>
    </message>
    <message>
        <source>start it again</source>
        <translation>noch einmal starten</translation>
    </message>
    <message>
        <source>the mirror plane is not understood</source>
        <translation>die Spiegelebene ist nicht verständlich</translation>
    </message>
    <message>
        <source>give x, y, z or a normal such as 0.1,1,0</source>
        <translation>x, y, z oder eine Normale wie 0.1,1,0 angeben</translation>
    </message>
    <message>
        <source>the feature kind is not known</source>
        <translation>die Merkmalsart ist nicht bekannt</translation>
    </message>
    <message>
        <source>choose a known one</source>
        <translation>eine bekannte wählen</translation>
    </message>
    <message>
        <source>how this feature kind is mirrored is not known</source>
        <translation>wie diese Merkmalsart gespiegelt wird, ist nicht bekannt</translation>
    </message>
    <message>
        <source>teach the spot with another kind</source>
        <translation>die Messstelle mit einer anderen Art einlernen</translation>
    </message>
    <message>
        <source>the mirror plane has no unit normal</source>
        <translation>die Spiegelebene hat keine Einheitsnormale</translation>
    </message>
    <message>
        <source>give x, y, z or a normal</source>
        <translation>x, y, z oder eine Normale angeben</translation>
    </message>
    <message>
        <source>a gripper with its sensors has no mirror image that is only taught differently</source>
        <translation>ein Greifer mit seinen Sensoren hat kein Spiegelbild, das nur anders eingelernt wäre</translation>
    </message>
    <message>
        <source>teach the panel job of the other side; mirror the project without it</source>
        <translation>die Greiferaufgabe der anderen Seite einlernen; das Projekt ohne sie spiegeln</translation>
    </message>
    <message>
        <source>the sensor has no calibration in use, its pose on the part is unknown</source>
        <translation>der Sensor hat keine Kalibrierung in Gebrauch, seine Pose am Teil ist unbekannt</translation>
    </message>
    <message>
        <source>calibrate the sensor first</source>
        <translation>zuerst den Sensor kalibrieren</translation>
    </message>
    <message>
        <source>an oblique plane mixes its free and fixed degrees of freedom</source>
        <translation>eine schräge Ebene vermischt seine freien und festen Freiheitsgrade</translation>
    </message>
    <message>
        <source>mirror about x, y or z, or free all translations and rotations</source>
        <translation>an x, y oder z spiegeln oder alle Verschiebungen und Drehungen freigeben</translation>
    </message>
    <message>
        <source>a %1 has no id</source>
        <translation>%1: ohne Kennung</translation>
    </message>
    <message>
        <source>give every one a name</source>
        <translation>jedem einen Namen geben</translation>
    </message>
    <message>
        <source>two %1s are called &quot;%2&quot;</source>
        <translation>zwei heißen „%2“ (%1)</translation>
    </message>
    <message>
        <source>rename one</source>
        <translation>einen umbenennen</translation>
    </message>
    <message>
        <source>an entry stands under another&apos;s id</source>
        <translation>ein Eintrag steht unter der Kennung eines anderen</translation>
    </message>
    <message>
        <source>the image&apos;s pixels do not fill its size</source>
        <translation>die Pixel des Bilds füllen seine Größe nicht</translation>
    </message>
    <message>
        <source>a block holds another number of profiles than it says</source>
        <translation>ein Block enthält eine andere Zahl von Profilen, als er sagt</translation>
    </message>
    <message>
        <source>an image does not fit its description</source>
        <translation>ein Bild passt nicht zu seiner Beschreibung</translation>
    </message>
    <message>
        <source>the checksum of an image is wrong: the file is damaged</source>
        <translation>die Prüfsumme eines Bilds stimmt nicht: die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>there is no run %1</source>
        <translation>es gibt keinen Lauf %1</translation>
    </message>
    <message>
        <source>an evidence is of unknown kind</source>
        <translation>ein Nachweis ist von unbekannter Art</translation>
    </message>
    <message>
        <source>a run has an unknown status</source>
        <translation>ein Lauf hat einen unbekannten Zustand</translation>
    </message>
    <message>
        <source>the run has an unknown status</source>
        <translation>der Lauf hat einen unbekannten Zustand</translation>
    </message>
    <message>
        <source>setup %1 is missing</source>
        <translation>Einrichtung %1 fehlt</translation>
    </message>
    <message>
        <source>an event has an unknown kind</source>
        <translation>ein Ereignis hat eine unbekannte Art</translation>
    </message>
    <message>
        <source>it is not in the project</source>
        <translation>ist nicht im Projekt</translation>
    </message>
    <message>
        <source>its spots were taught without a calibration, so that nobody knows where it stood</source>
        <translation>seine Messstellen wurden ohne Kalibrierung eingelernt, sodass niemand weiß, wo er stand</translation>
    </message>
    <message>
        <source>teach them again</source>
        <translation>neu einlernen</translation>
    </message>
    <message>
        <source>there is no calibration &quot;%1&quot;</source>
        <translation>es gibt keine Kalibrierung „%1“</translation>
    </message>
    <message>
        <source>its spots were taught in pixels, so that their references are no millimetres</source>
        <translation>seine Stellen wurden in Pixeln gelehrt, die Bezüge sind also keine Millimeter</translation>
    </message>
    <message>
        <source>holds colour, no coordinates</source>
        <translation>enthält Farbe, keine Koordinaten</translation>
    </message>
    <message>
        <source>&quot;%1&quot; is no channel</source>
        <translation>„%1“ ist kein Kanal</translation>
    </message>
    <message>
        <source>give grey, red, green, blue or red-difference</source>
        <translation>grey, red, green, blue oder red-difference angeben</translation>
    </message>
    <message>
        <source>import the recording again with --calibration</source>
        <translation>die Aufzeichnung mit --calibration neu importieren</translation>
    </message>
    <message>
        <source>calibrate the new sensor first</source>
        <translation>zuerst den neuen Sensor kalibrieren</translation>
    </message>
    <message>
        <source>calibration %1 belongs to sensor %2</source>
        <translation>Kalibrierung %1 gehört zu Sensor %2</translation>
    </message>
    <message>
        <source>choose one of this sensor</source>
        <translation>eine dieses Sensors wählen</translation>
    </message>
    <message>
        <source>calibration %1 is %2</source>
        <translation>Kalibrierung %1: %2</translation>
    </message>
    <message>
        <source>calibrate again</source>
        <translation>noch einmal kalibrieren</translation>
    </message>
    <message>
        <source>spot %1 is measured by another sensor and would stay behind</source>
        <translation>Messstelle %1 wird von einem anderen Sensor gemessen und bliebe zurück</translation>
    </message>
    <message>
        <source>exchange one robot of a project with a single sensor</source>
        <translation>einen Roboter eines Projekts mit einem einzigen Sensor tauschen</translation>
    </message>
    <message>
        <source>this is a recorded capture, no project</source>
        <translation>dies ist eine Aufzeichnung, kein Projekt</translation>
    </message>
    <message>
        <source>name it in the settings of a sensor of driver &quot;replay&quot;: {&quot;file&quot;: ...}</source>
        <translation>sie in den Einstellungen eines Sensors mit Treiber &quot;replay&quot; nennen: {&quot;file&quot;: ...}</translation>
    </message>
    <message>
        <source>this is another program&apos;s database, no project file</source>
        <translation>dies ist die Datenbank eines anderen Programms, keine Projektdatei</translation>
    </message>
    <message>
        <source>the project file has version %1, this program knows up to %2</source>
        <translation>die Projektdatei hat Version %1, dieses Programm kennt bis %2</translation>
    </message>
    <message>
        <source>the project file has no valid version</source>
        <translation>die Projektdatei hat keine gültige Version</translation>
    </message>
    <message>
        <source>the project file is damaged (%1)</source>
        <translation>die Projektdatei ist beschädigt (%1)</translation>
    </message>
    <message>
        <source>only a simulated cell knows its own calibration</source>
        <translation>nur eine simulierte Zelle kennt ihre eigene Kalibrierung</translation>
    </message>
    <message>
        <source>calibrate the sensor</source>
        <translation>den Sensor kalibrieren</translation>
    </message>
    <message>
        <source>teach a spot, or run its panel job (seamwright panel)</source>
        <translation>eine Messstelle einlernen oder seine Greiferaufgabe ausführen (seamwright panel)</translation>
    </message>
    <message>
        <source>%1 repeats</source>
        <translation>%1 Wiederholungen</translation>
    </message>
    <message>
        <source>give 1 to 1000</source>
        <translation>1 bis 1000 angeben</translation>
    </message>
    <message>
        <source>a step of %1 mm</source>
        <translation>eine Schrittweite von %1 mm</translation>
    </message>
    <message>
        <source>give 0.05 mm or more</source>
        <translation>0.05 mm oder mehr angeben</translation>
    </message>
    <message>
        <source>%1 runs</source>
        <translation>%1 Läufe</translation>
    </message>
    <message>
        <source>give 2 to 1000</source>
        <translation>2 bis 1000 angeben</translation>
    </message>
    <message>
        <source>cancelled after %1 runs</source>
        <translation>abgebrochen nach %1 Läufen</translation>
    </message>
    <message>
        <source>the capture of spot %1 is missing</source>
        <translation>die Aufnahme von Messstelle %1 fehlt</translation>
    </message>
    <message>
        <source>the setup of the run has no panel job %1</source>
        <translation>die Einrichtung des Laufs hat keine Greiferaufgabe %1</translation>
    </message>
    <message>
        <source>the capture of place %1 is missing</source>
        <translation>die Aufnahme von Stelle %1 fehlt</translation>
    </message>
    <message>
        <source>the setup of the run has no place %1</source>
        <translation>die Einrichtung des Laufs hat keine Stelle %1</translation>
    </message>
    <message>
        <source>%1 jobs are not possible</source>
        <translation>%1 gleichzeitige Aufgaben sind nicht möglich</translation>
    </message>
    <message>
        <source>give 1 to 256</source>
        <translation>1 bis 256 angeben</translation>
    </message>
    <message>
        <source>%1 was expected, this is %2</source>
        <translation>%1 wurde erwartet, dies ist %2</translation>
    </message>
    <message>
        <source>the number is too large</source>
        <translation>die Zahl ist zu groß</translation>
    </message>
    <message>
        <source>%1 entries were expected, there are %2</source>
        <translation>%1 Einträge wurden erwartet, es sind %2</translation>
    </message>
    <message>
        <source>the word is not known here</source>
        <translation>das Wort ist hier nicht bekannt</translation>
    </message>
    <message>
        <source>the number is out of range</source>
        <translation>die Zahl liegt außerhalb des Bereichs</translation>
    </message>
    <message>
        <source>an entry of the project file cannot be read</source>
        <translation>ein Eintrag der Projektdatei kann nicht gelesen werden</translation>
    </message>
    <message>
        <source>sensor %1</source>
        <translation>Sensor %1</translation>
    </message>
    <message>
        <source>robot %1</source>
        <translation>Roboter %1</translation>
    </message>
    <message>
        <source>spot %1</source>
        <translation>Messstelle %1</translation>
    </message>
    <message>
        <source>region %1</source>
        <translation>Korrekturbereich %1</translation>
    </message>
    <message>
        <source>camera %1</source>
        <translation>Kamera %1</translation>
    </message>
    <message>
        <source>camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>run %1</source>
        <translation>Lauf %1</translation>
    </message>
    <message>
        <source>frame %1</source>
        <translation>Bild %1</translation>
    </message>
    <message>
        <source>robot</source>
        <translation>Roboter</translation>
    </message>
    <message>
        <source>sensor &quot;%1&quot;</source>
        <translation>Sensor „%1“</translation>
    </message>
    <message>
        <source>source &quot;%1&quot;</source>
        <translation>Quelle „%1“</translation>
    </message>
    <message>
        <source>simulated sensor</source>
        <translation>simulierter Sensor</translation>
    </message>
    <message>
        <source>simulated robot</source>
        <translation>simulierter Roboter</translation>
    </message>
    <message>
        <source>simulated</source>
        <translation>simuliert</translation>
    </message>
    <message>
        <source>replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <source>alignment pass</source>
        <translation>Durchfahrt</translation>
    </message>
    <message>
        <source>alignment options</source>
        <translation>Einstellungen der Durchfahrt</translation>
    </message>
    <message>
        <source>profile %1 of the pass</source>
        <translation>Profil %1 der Durchfahrt</translation>
    </message>
    <message>
        <source>capture of spot %1</source>
        <translation>Aufnahme von Messstelle %1</translation>
    </message>
    <message>
        <source>zero shift</source>
        <translation>Nullverschiebung</translation>
    </message>
    <message>
        <source>known shift</source>
        <translation>bekannte Verschiebung</translation>
    </message>
    <message>
        <source>contour curve</source>
        <translation>Konturkurve</translation>
    </message>
    <message>
        <source>panel job %1</source>
        <translation>Greiferaufgabe %1</translation>
    </message>
    <message>
        <source>work object</source>
        <translation>Werkobjekt</translation>
    </message>
    <message>
        <source>pairs</source>
        <translation>Paare</translation>
    </message>
    <message>
        <source>views</source>
        <translation>Ansichten</translation>
    </message>
    <message>
        <source>points</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>poses</source>
        <translation>Posen</translation>
    </message>
    <message>
        <source>images</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>lines</source>
        <translation>Linien</translation>
    </message>
    <message>
        <source>measurements</source>
        <translation>Messungen</translation>
    </message>
    <message>
        <source>observations</source>
        <translation>Beobachtungen</translation>
    </message>
    <message>
        <source>observation &apos;%1&apos;</source>
        <translation>Beobachtung „%1“</translation>
    </message>
    <message>
        <source>point &apos;%1&apos;</source>
        <translation>Punkt „%1“</translation>
    </message>
    <message>
        <source>board</source>
        <translation>Tafel</translation>
    </message>
    <message>
        <source>sensors</source>
        <translation>Sensoren</translation>
    </message>
    <message>
        <source>spots</source>
        <translation>Messstellen</translation>
    </message>
    <message>
        <source>template</source>
        <translation>Vorlage</translation>
    </message>
    <message>
        <source>image</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>plane</source>
        <translation>Ebene</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzen</translation>
    </message>
    <message>
        <source>window</source>
        <translation>Fenster</translation>
    </message>
    <message>
        <source>a telegram of the robot</source>
        <translation>ein Telegramm des Roboters</translation>
    </message>
    <message>
        <source>damaged frame: %1</source>
        <translation>beschädigtes Bild: %1</translation>
    </message>
    <message>
        <source>the frame is empty</source>
        <translation>das Bild ist leer</translation>
    </message>
    <message>
        <source>no calibration: the image has no millimetres</source>
        <translation>keine Kalibrierung: das Bild hat keine Millimeter</translation>
    </message>
    <message>
        <source>the part has to be started again</source>
        <translation>das Teil muss neu gestartet werden</translation>
    </message>
    <message>
        <source>the window holds fewer than 20 points of the contour</source>
        <translation>das Fenster enthält weniger als 20 Punkte der Kontur</translation>
    </message>
    <message>
        <source>drag a larger one</source>
        <translation>ein größeres ziehen</translation>
    </message>
    <message>
        <source>project</source>
        <translation>Projekt</translation>
    </message>
    <message>
        <source>project file</source>
        <translation>Projektdatei</translation>
    </message>
    <message>
        <source>capture</source>
        <translation>Aufzeichnung</translation>
    </message>
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
        <source>calibration</source>
        <translation>Kalibrierung</translation>
    </message>
    <message>
        <source>an object</source>
        <translation>ein Objekt</translation>
    </message>
    <message>
        <source>an array</source>
        <translation>eine Liste</translation>
    </message>
    <message>
        <source>a number</source>
        <translation>eine Zahl</translation>
    </message>
    <message>
        <source>a text</source>
        <translation>ein Text</translation>
    </message>
    <message>
        <source>corrupt</source>
        <translation>beschädigt</translation>
    </message>
    <message>
        <source>late</source>
        <translation>verspätet</translation>
    </message>
    <message>
        <source>incomplete</source>
        <translation>unvollständig</translation>
    </message>
    <message>
        <source>camera and laser plane</source>
        <translation>Kamera und Laserebene</translation>
    </message>
    <message>
        <source>only %1 of the %2 robot poses differ from one another</source>
        <translation>nur %1 der %2 Roboterposen unterscheiden sich</translation>
    </message>
    <message>
        <source>a text is not UTF-8</source>
        <translation>ein Text ist nicht UTF-8</translation>
    </message>
    <message>
        <source>use plain letters in names</source>
        <translation>in Namen einfache Buchstaben verwenden</translation>
    </message>
    <message>
        <source>the feature kind &quot;%1&quot; is not known</source>
        <translation>die Merkmalsart „%1“ ist nicht bekannt</translation>
    </message>
    <message>
        <source>it is there already</source>
        <translation>ist schon da</translation>
    </message>
    <message>
        <source>give the project another name</source>
        <translation>dem Projekt einen anderen Namen geben</translation>
    </message>
    <message>
        <source>rotation about %1</source>
        <translation>Drehung um %1</translation>
    </message>
    <message>
        <source>rotation about %1 through (%2)</source>
        <translation>Drehung um %1 durch (%2) mm</translation>
    </message>
    <message>
        <source>rotation about the axis %1</source>
        <translation>Drehung um die Achse %1</translation>
    </message>
    <message>
        <source>rotation about the axis %1 through (%2)</source>
        <translation>Drehung um die Achse %1 durch (%2) mm</translation>
    </message>
    <message>
        <source>rotation about %1 with %2 mm along it per degree</source>
        <translation>Drehung um %1 mit %2 mm entlang ihr je Grad</translation>
    </message>
    <message>
        <source>translation along %1</source>
        <translation>Verschiebung entlang %1</translation>
    </message>
    <message>
        <source>the spots do not determine the %1: add a spot whose edge runs in another direction</source>
        <translation>die Messstellen bestimmen nicht: %1; eine Messstelle hinzufügen, deren Kante in eine andere Richtung verläuft</translation>
    </message>
    <message>
        <source>add spots whose edges run in other directions and which lie far apart: no few further spots near the taught ones would do</source>
        <translation>Messstellen hinzufügen, deren Kanten in andere Richtungen verlaufen und die weit auseinanderliegen: wenige weitere nahe den eingelernten genügen nicht</translation>
    </message>
    <message>
        <source>add a spot near %1 at (%2) mm of the work object with its edge along %3: the weakest direction goes from %4 to %5 (1 sigma at the spots)</source>
        <translation>eine Messstelle nahe %1 bei (%2) mm im Werkobjekt hinzufügen, ihre Kante entlang %3: die schwächste Richtung geht von %4 auf %5 (1 Sigma an den Messstellen)</translation>
    </message>
    <message>
        <source>add a spot near %1 at (%2) mm of the work object with its edge along %3: the weakest direction goes from %4 to %5 (1 sigma at the spots), and the number of spots whose wrong measure would go unnoticed from %6 to %7</source>
        <translation>eine Messstelle nahe %1 bei (%2) mm im Werkobjekt hinzufügen, ihre Kante entlang %3: die schwächste Richtung geht von %4 auf %5 (1 Sigma an den Messstellen), und die Zahl der Messstellen, deren falsches Maß unbemerkt bliebe, von %6 auf %7</translation>
    </message>
    <message>
        <source>no further spot is needed; the best one would be near %1 at (%2) mm of the work object with its edge along %3: the weakest direction goes from %4 to %5 (1 sigma at the spots)</source>
        <translation>keine weitere Messstelle ist nötig; die beste läge nahe %1 bei (%2) mm im Werkobjekt, ihre Kante entlang %3: die schwächste Richtung ginge von %4 auf %5 (1 Sigma an den Messstellen)</translation>
    </message>
    <message>
        <source>the simulated cell&apos;s own optics and mounting</source>
        <translation>der Optik und dem Anbau der simulierten Zelle</translation>
    </message>
    <message>
        <source>simulated truth</source>
        <translation>Wahrheit der Simulation</translation>
    </message>
    <message>
        <source>regions corrected and pushed: %1</source>
        <translation>Korrekturbereiche korrigiert und übertragen: %1</translation>
    </message>
    <message>
        <source>regions corrected, nothing pushed (dry run): %1</source>
        <translation>Korrekturbereiche korrigiert, nichts übertragen (Probelauf): %1</translation>
    </message>
</context>
<context>
    <name>MethodText</name>
    <message>
        <source>Sensor on the flange (sphere)</source>
        <translation>Sensor am Flansch (Kugel)</translation>
    </message>
    <message>
        <source>Finds where the sensor sits on the flange, from cuts through one fixed sphere.</source>
        <translation>Findet, wo der Sensor am Flansch sitzt, aus Schnitten durch eine feste Kugel.</translation>
    </message>
    <message>
        <source>A matt sphere of known radius on a stiff post that nobody touches.</source>
        <translation>Eine matte Kugel mit bekanntem Radius auf einem steifen Pfosten, den niemand berührt.</translation>
    </message>
    <message>
        <source>Camera and laser plane calibrated: the profile must be in millimetres.</source>
        <translation>Kamera und Laserebene kalibriert: das Profil muss in Millimetern sein.</translation>
    </message>
    <message>
        <source>9 or more poses: the stripe off the middle to both sides, the sensor turned about all three axes by 20 degrees and more.</source>
        <translation>9 oder mehr Posen: die Linie zu beiden Seiten neben der Mitte, der Sensor um alle drei Achsen um 20 Grad und mehr gedreht.</translation>
    </message>
    <message>
        <source>JSON with radius, robot poses and profiles</source>
        <translation>JSON mit Radius, Roboterposen und Profilen</translation>
    </message>
    <message>
        <source>Camera and laser plane (board)</source>
        <translation>Kamera und Laserebene (Tafel)</translation>
    </message>
    <message>
        <source>Finds lens, laser plane and, with robot poses, the place on the flange, from one board.</source>
        <translation>Findet Objektiv, Laserebene und, mit Roboterposen, den Platz am Flansch, aus einer Tafel.</translation>
    </message>
    <message>
        <source>A flat chessboard, its corners counted and its pitch known.</source>
        <translation>Eine ebene Schachbretttafel mit gezählten Ecken und bekannter Teilung.</translation>
    </message>
    <message>
        <source>10 or more pictures with the stripe across the board, tilted to both sides about both axes, at different heights, out to the corners of the picture.</source>
        <translation>10 oder mehr Bilder mit der Linie quer über die Tafel, zu beiden Seiten um beide Achsen geneigt, in verschiedenen Höhen, bis in die Bildecken.</translation>
    </message>
    <message>
        <source>The board stays where it is; only the robot moves.</source>
        <translation>Die Tafel bleibt, wo sie ist; nur der Roboter bewegt sich.</translation>
    </message>
    <message>
        <source>folder of images with pose files</source>
        <translation>Ordner mit Bildern und Posendateien</translation>
    </message>
    <message>
        <source>Camera on the flange (hand-eye)</source>
        <translation>Kamera am Flansch (Hand-Auge)</translation>
    </message>
    <message>
        <source>Finds where the camera sits on the flange, from views of one fixed board.</source>
        <translation>Findet, wo die Kamera am Flansch sitzt, aus Ansichten einer festen Tafel.</translation>
    </message>
    <message>
        <source>A flat chessboard that stays where it is.</source>
        <translation>Eine ebene Schachbretttafel, die bleibt, wo sie ist.</translation>
    </message>
    <message>
        <source>A calibrated camera: the board&apos;s place in the picture must be right.</source>
        <translation>Eine kalibrierte Kamera: der Platz der Tafel im Bild muss stimmen.</translation>
    </message>
    <message>
        <source>8 or more poses turned about at least two axes.</source>
        <translation>8 oder mehr Posen, um mindestens zwei Achsen gedreht.</translation>
    </message>
    <message>
        <source>JSON with pairs of poses, or a folder of images with pose files</source>
        <translation>JSON mit Posenpaaren oder ein Ordner mit Bildern und Posendateien</translation>
    </message>
    <message>
        <source>Laser plane (triangular body)</source>
        <translation>Laserebene (Dreikantkörper)</translation>
    </message>
    <message>
        <source>Finds the laser plane in a known camera, from the apex of a triangular body.</source>
        <translation>Findet die Laserebene in einer bekannten Kamera, aus der Spitze eines Dreikantkörpers.</translation>
    </message>
    <message>
        <source>A triangular body square to the sensor, its apex seen in the picture.</source>
        <translation>Ein zum Sensor rechtwinklig liegender Dreikantkörper, dessen Spitze im Bild gesehen wird.</translation>
    </message>
    <message>
        <source>A sensor that gives profiles in millimetres; or the robot as the stage: it shifts the sensor along its own X and Z alone and never turns it.</source>
        <translation>Ein Sensor, der Profile in Millimetern liefert; oder der Roboter als Verstelltisch: er verschiebt den Sensor nur in dessen X und Z und dreht ihn nie.</translation>
    </message>
    <message>
        <source>10 or more positions spread over the field, not on one line.</source>
        <translation>10 oder mehr über das Messfeld verteilte Stellungen, nicht auf einer Linie.</translation>
    </message>
    <message>
        <source>JSON with pairs of pixel and laser point</source>
        <translation>JSON mit Paaren aus Pixel und Laserpunkt</translation>
    </message>
    <message>
        <source>Look-up table</source>
        <translation>Nachschlagetabelle</translation>
    </message>
    <message>
        <source>Maps pixels to millimetres directly, from a target at known places.</source>
        <translation>Bildet Pixel direkt auf Millimeter ab, aus einem Ziel an bekannten Plätzen.</translation>
    </message>
    <message>
        <source>A triangular body square to the sensor, and the robot that shifts the sensor along its own X and Z alone; or pairs measured on a stage, from a file.</source>
        <translation>Ein zum Sensor rechtwinklig liegender Dreikantkörper und der Roboter, der den Sensor nur in dessen X und Z verschiebt; oder auf einem Verstelltisch gemessene Paare, aus einer Datei.</translation>
    </message>
    <message>
        <source>25 or more places over the whole field; what lies outside is not measured later.</source>
        <translation>25 oder mehr Plätze über das ganze Messfeld; was außerhalb liegt, wird später nicht gemessen.</translation>
    </message>
    <message>
        <source>JSON with pairs of pixel and known place</source>
        <translation>JSON mit Paaren aus Pixel und bekanntem Platz</translation>
    </message>
    <message>
        <source>Static one-shot for several sensors</source>
        <translation>Statisch mit einer Aufnahme für mehrere Sensoren</translation>
    </message>
    <message>
        <source>Puts all sensors of a gripper into one frame, from one picture each of a known plate.</source>
        <translation>Bringt alle Sensoren eines Greifers in ein Koordinatensystem, aus je einem Bild einer bekannten Platte.</translation>
    </message>
    <message>
        <source>A plate whose place is known (&quot;Plate in the world&quot;), seen by the camera.</source>
        <translation>Eine Platte, deren Ort bekannt ist („Platte in der Welt“) und die von der Kamera gesehen wird.</translation>
    </message>
    <message>
        <source>The laser plane in the camera; the robot tells where the flange stands.</source>
        <translation>Die Laserebene in der Kamera; der Roboter sagt, wo der Flansch steht.</translation>
    </message>
    <message>
        <source>JSON with the chain of poses of each sensor</source>
        <translation>JSON mit der Posenkette jedes Sensors</translation>
    </message>
    <message>
        <source>Lens</source>
        <translation>Objektiv</translation>
    </message>
    <message>
        <source>Checks the lens: straight laser lines on a plate must become straight.</source>
        <translation>Prüft das Objektiv: gerade Laserlinien auf einer Platte müssen gerade werden.</translation>
    </message>
    <message>
        <source>A flat plate that fills the view.</source>
        <translation>Eine ebene Platte, die das Bild füllt.</translation>
    </message>
    <message>
        <source>10 or more heights and tilts, so that the lines cross the picture everywhere.</source>
        <translation>10 oder mehr Höhen und Neigungen, sodass die Linien überall durchs Bild laufen.</translation>
    </message>
    <message>
        <source>JSON with lines of pixels</source>
        <translation>JSON mit Linien aus Pixeln</translation>
    </message>
    <message>
        <source>Plate in the world</source>
        <translation>Platte in der Welt</translation>
    </message>
    <message>
        <source>Finds where a plate stands, from points known on it and measured in the world.</source>
        <translation>Findet, wo eine Platte steht, aus Punkten, die auf ihr bekannt und in der Welt gemessen sind.</translation>
    </message>
    <message>
        <source>A board on the plate and the calibrated sensor on the robot: every capture gives its outer corners.</source>
        <translation>Ein Schachbrett auf der Platte und der kalibrierte Sensor am Roboter: jede Aufnahme liefert dessen äußere Ecken.</translation>
    </message>
    <message>
        <source>Or 6 or more points measured by robot tip, laser tracker or total station, from a file: far apart and not on one line.</source>
        <translation>Oder 6 und mehr Punkte, gemessen mit Roboterspitze, Lasertracker oder Tachymeter, aus einer Datei: weit auseinander und nicht auf einer Linie.</translation>
    </message>
    <message>
        <source>JSON with points on the plate and in the world</source>
        <translation>JSON mit Punkten auf der Platte und in der Welt</translation>
    </message>
    <message>
        <source>Does the calibration still hold?</source>
        <translation>Gilt die Kalibrierung noch?</translation>
    </message>
    <message>
        <source>Measures the sphere again and says whether the sensor has moved on its flange.</source>
        <translation>Misst die Kugel erneut und sagt, ob sich der Sensor am Flansch bewegt hat.</translation>
    </message>
    <message>
        <source>The sphere where it stood when the sensor was calibrated.</source>
        <translation>Die Kugel, wo sie bei der Kalibrierung des Sensors stand.</translation>
    </message>
    <message>
        <source>3 poses from different directions.</source>
        <translation>3 Posen aus verschiedenen Richtungen.</translation>
    </message>
    <message>
        <source>JSON with stored calibration and new profiles</source>
        <translation>JSON mit abgelegter Kalibrierung und neuen Profilen</translation>
    </message>
    <message>
        <source>Radius of the sphere</source>
        <translation>Radius der Kugel</translation>
    </message>
    <message>
        <source>Corners along</source>
        <translation>Ecken längs</translation>
    </message>
    <message>
        <source>Corners across</source>
        <translation>Ecken quer</translation>
    </message>
    <message>
        <source>Edge of a square</source>
        <translation>Kante eines Feldes</translation>
    </message>
    <message>
        <source>Allowed shift</source>
        <translation>Erlaubte Verschiebung</translation>
    </message>
    <message>
        <source>Allowed turn</source>
        <translation>Erlaubte Drehung</translation>
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
    <name>Words</name>
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
        <translation>keine Laserlinie</translation>
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
        <translation>Hand, volle Geschwindigkeit (T2)</translation>
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
        <source>The side on which the contour ends.</source>
        <translation>Die Seite, auf der die Kontur endet.</translation>
    </message>
    <message>
        <source>Which end is meant where several lie in the window: the outermost on that side, that of the longest, the highest or the lowest contour, or the only one.</source>
        <translation>Welches Ende gemeint ist, wenn mehrere im Fenster liegen: das äußerste auf dieser Seite, das der längsten, der höchsten oder der niedrigsten Kontur, oder das einzige.</translation>
    </message>
    <message>
        <source>Outermost: the how-manyth end from outside.</source>
        <translation>Äußerstes: das wievielte Ende von außen.</translation>
    </message>
    <message>
        <source>Left rim of the sensor&apos;s field, where profiles come without their empty lines.</source>
        <translation>Linker Rand des Sensorfelds, wenn Profile ohne ihre leeren Zeilen kommen.</translation>
    </message>
    <message>
        <source>Right rim of the sensor&apos;s field, where profiles come without their empty lines.</source>
        <translation>Rechter Rand des Sensorfelds, wenn Profile ohne ihre leeren Zeilen kommen.</translation>
    </message>
    <message>
        <source>Automatic split: which corner is meant where several lie in the window.</source>
        <translation>Automatische Teilung: welche Ecke gemeint ist, wenn mehrere im Fenster liegen.</translation>
    </message>
    <message>
        <source>Shorter segments are passed over.</source>
        <translation>Kürzere Segmente werden übergangen.</translation>
    </message>
    <message>
        <source>Length of contour before its end that says where the line goes.</source>
        <translation>Länge der Kontur vor ihrem Ende, die die Richtung der Linie bestimmt.</translation>
    </message>
    <message>
        <source>Where the left line ends and the right one begins: found, or given by two x ranges.</source>
        <translation>Wo die linke Linie endet und die rechte beginnt: gefunden oder durch zwei x-Bereiche vorgegeben.</translation>
    </message>
    <message>
        <source>Given split: the left line&apos;s first x.</source>
        <translation>Vorgegebene Teilung: erstes x der linken Linie.</translation>
    </message>
    <message>
        <source>Given split: the left line&apos;s last x.</source>
        <translation>Vorgegebene Teilung: letztes x der linken Linie.</translation>
    </message>
    <message>
        <source>Given split: the right line&apos;s first x.</source>
        <translation>Vorgegebene Teilung: erstes x der rechten Linie.</translation>
    </message>
    <message>
        <source>Given split: the right line&apos;s last x.</source>
        <translation>Vorgegebene Teilung: letztes x der rechten Linie.</translation>
    </message>
    <message>
        <source>Automatic split: length of each line from the corner; 0 takes all.</source>
        <translation>Automatische Teilung: Länge jeder Linie ab der Ecke; 0 nimmt alles.</translation>
    </message>
    <message>
        <source>Points nearer to the corner than this are left out: radius or burr.</source>
        <translation>Punkte näher an der Ecke bleiben außer Acht: Radius oder Grat.</translation>
    </message>
    <message>
        <source>Lines that meet at a smaller angle make no corner.</source>
        <translation>Linien, die sich in kleinerem Winkel treffen, bilden keine Ecke.</translation>
    </message>
    <message>
        <source>The radius when it is known; 0 fits it.</source>
        <translation>Der Radius, wenn er bekannt ist; 0 passt ihn an.</translation>
    </message>
    <message>
        <source>Free radius: the smallest that is accepted.</source>
        <translation>Freier Radius: der kleinste, der angenommen wird.</translation>
    </message>
    <message>
        <source>Free radius: the largest that is accepted.</source>
        <translation>Freier Radius: der größte, der angenommen wird.</translation>
    </message>
    <message>
        <source>The least arc that must be seen.</source>
        <translation>Der kleinste Bogen, der zu sehen sein muss.</translation>
    </message>
    <message>
        <source>The extremum that is meant.</source>
        <translation>Das Extremum, das gemeint ist.</translation>
    </message>
    <message>
        <source>Length of contour around the extremum that the parabola takes.</source>
        <translation>Länge der Kontur um das Extremum, die die Parabel nimmt.</translation>
    </message>
    <message>
        <source>Left limit of the search window.</source>
        <translation>Linke Grenze des Suchfensters.</translation>
    </message>
    <message>
        <source>Right limit of the search window.</source>
        <translation>Rechte Grenze des Suchfensters.</translation>
    </message>
    <message>
        <source>Lower limit of the search window.</source>
        <translation>Untere Grenze des Suchfensters.</translation>
    </message>
    <message>
        <source>Upper limit of the search window.</source>
        <translation>Obere Grenze des Suchfensters.</translation>
    </message>
    <message>
        <source>How far along x the contour may have moved, +-.</source>
        <translation>Wie weit die Kontur entlang x verschoben sein darf, +-.</translation>
    </message>
    <message>
        <source>How far along z the contour may have moved, +-.</source>
        <translation>Wie weit die Kontur entlang z verschoben sein darf, +-.</translation>
    </message>
    <message>
        <source>How far the contour may have turned, +-.</source>
        <translation>Wie weit die Kontur gedreht sein darf, +-.</translation>
    </message>
    <message>
        <source>Share of the template that must be seen.</source>
        <translation>Anteil der Vorlage, der zu sehen sein muss.</translation>
    </message>
    <message>
        <source>Travel before the trigger, along the sensor&apos;s Y.</source>
        <translation>Weg vor dem Trigger, entlang Y des Sensors.</translation>
    </message>
    <message>
        <source>Travel after the trigger, along the sensor&apos;s Y.</source>
        <translation>Weg nach dem Trigger, entlang Y des Sensors.</translation>
    </message>
    <message>
        <source>Speed of the pass.</source>
        <translation>Geschwindigkeit der Durchfahrt.</translation>
    </message>
    <message>
        <source>Standard deviation of a measured coordinate, with jitter.</source>
        <translation>Standardabweichung einer gemessenen Koordinate, mit Streuung.</translation>
    </message>
    <message>
        <source>Half width of the trigger jitter along the travel.</source>
        <translation>Halbe Breite der Triggerstreuung entlang des Wegs.</translation>
    </message>
    <message>
        <source>How much the sensor&apos;s X counts; 0 = not observed.</source>
        <translation>Wie viel X des Sensors zählt; 0 = nicht beobachtet.</translation>
    </message>
    <message>
        <source>How much the travel direction Y counts; a profile does not see it.</source>
        <translation>Wie viel die Fahrtrichtung Y zählt; ein Profil sieht sie nicht.</translation>
    </message>
    <message>
        <source>How much the sensor&apos;s Z (height) counts; 0 = not observed.</source>
        <translation>Wie viel Z des Sensors (Höhe) zählt; 0 = nicht beobachtet.</translation>
    </message>
    <message>
        <source>Larger displacements are refused.</source>
        <translation>Größere Verschiebungen werden abgelehnt.</translation>
    </message>
    <message>
        <source>Larger turns are refused.</source>
        <translation>Größere Drehungen werden abgelehnt.</translation>
    </message>
    <message>
        <source>A correction less sure than this is not pushed.</source>
        <translation>Eine unsicherere Korrektur wird nicht übertragen.</translation>
    </message>
    <message>
        <source>A turn less sure than this is not pushed.</source>
        <translation>Eine unsicherere Drehung wird nicht übertragen.</translation>
    </message>
    <message>
        <source>Exposure time.</source>
        <translation>Belichtungszeit.</translation>
    </message>
    <message>
        <source>Gain after exposure; 0 dB shows a full well as full scale.</source>
        <translation>Verstärkung nach der Belichtung; bei 0 dB ist ein voller Pixel Vollausschlag.</translation>
    </message>
    <message>
        <source>Gain, as the camera calls it.</source>
        <translation>Verstärkung, wie die Kamera sie nennt.</translation>
    </message>
    <message>
        <source>Laser on or off.</source>
        <translation>Laser ein oder aus.</translation>
    </message>
    <message>
        <source>Frames a second when free running.</source>
        <translation>Bilder je Sekunde im freien Lauf.</translation>
    </message>
    <message>
        <source>Frames per second; 0 replays as fast as frames are asked for.</source>
        <translation>Bilder je Sekunde; 0 spielt so schnell ab, wie Bilder verlangt werden.</translation>
    </message>
    <message>
        <source>First column of the image.</source>
        <translation>Erste Spalte des Bilds.</translation>
    </message>
    <message>
        <source>First row of the image.</source>
        <translation>Erste Zeile des Bilds.</translation>
    </message>
    <message>
        <source>Columns of the image.</source>
        <translation>Spalten des Bilds.</translation>
    </message>
    <message>
        <source>Rows of the image.</source>
        <translation>Zeilen des Bilds.</translation>
    </message>
    <message>
        <source>How grey values or coordinates are coded.</source>
        <translation>Wie Grauwerte oder Koordinaten kodiert sind.</translation>
    </message>
    <message>
        <source>What starts an exposure.</source>
        <translation>Was eine Belichtung auslöst.</translation>
    </message>
    <message>
        <source>A car door before a stripe camera, rendered</source>
        <translation>Eine Autotür vor einer Laserlinienkamera, gerechnet</translation>
    </message>
    <message>
        <source>A panel in a gripper before a body&apos;s opening, rendered</source>
        <translation>Ein Anbauteil im Greifer vor der Öffnung einer Karosserie, gerechnet</translation>
    </message>
    <message>
        <source>A robot whose gripper holds a panel</source>
        <translation>Ein Roboter, dessen Greifer ein Anbauteil hält</translation>
    </message>
    <message>
        <source>A recorded capture, or profiles (CSV) or images of a folder, with poses</source>
        <translation>Eine Aufzeichnung, oder Profile (CSV) oder Bilder eines Ordners, mit Posen</translation>
    </message>
    <message>
        <source>GigE Vision and USB3 Vision cameras, images or profiles (GenICam)</source>
        <translation>Kameras mit GigE Vision und USB3 Vision, Bilder oder Profile (GenICam)</translation>
    </message>
    <message>
        <source>A robot with repeatability and trigger jitter</source>
        <translation>Ein Roboter mit Wiederholgenauigkeit und Triggerstreuung</translation>
    </message>
    <message>
        <source>KUKA, the controller connects by EthernetKRL</source>
        <translation>KUKA, die Steuerung verbindet sich über EthernetKRL</translation>
    </message>
    <message>
        <source>KUKA, variables of the controller by KUKAVARPROXY</source>
        <translation>KUKA, Variablen der Steuerung über KUKAVARPROXY</translation>
    </message>
    <message>
        <source>KUKA path correction in every cycle (RSI)</source>
        <translation>KUKA, Bahnkorrektur in jedem Takt (RSI)</translation>
    </message>
    <message>
        <source>The poses and spots of a recorded capture or folder</source>
        <translation>Die Posen und Messstellen einer Aufzeichnung oder eines Ordners</translation>
    </message>
    <message>
        <source>Universal Robots, registers and poses by RTDE</source>
        <translation>Universal Robots, Register und Posen über RTDE</translation>
    </message>
    <message>
        <source>ABB controller with our RAPID server task (TCP)</source>
        <translation>ABB-Steuerung mit unserer RAPID-Servertask (TCP)</translation>
    </message>
    <message>
        <source>ABB path correction in every cycle (EGM)</source>
        <translation>ABB, Bahnkorrektur in jedem Takt (EGM)</translation>
    </message>
    <message>
        <source>Where the surface stops, seen from the left or the right.</source>
        <translation>Wo die Fläche aufhört, von links oder rechts gesehen.</translation>
    </message>
    <message>
        <source>The intersection of two lines fitted left and right of an edge.</source>
        <translation>Der Schnittpunkt zweier Linien links und rechts einer Kante.</translation>
    </message>
    <message>
        <source>The centre of a round piece of contour.</source>
        <translation>Der Mittelpunkt eines runden Konturstücks.</translation>
    </message>
    <message>
        <source>The highest, lowest, leftmost or rightmost place of the contour.</source>
        <translation>Die höchste, tiefste, linkeste oder rechteste Stelle der Kontur.</translation>
    </message>
    <message>
        <source>A taught piece of contour found again; it carries its reference point along.</source>
        <translation>Ein eingelerntes Konturstück, wiedergefunden; es trägt seinen Referenzpunkt mit.</translation>
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
        <source>LMI Gocator, profiles or the results of its own tools over TCP</source>
        <translation>LMI Gocator, Profile oder Ergebnisse seiner eigenen Werkzeuge über TCP</translation>
    </message>
    <message>
        <source>A point that the sensor&apos;s own tools have measured.</source>
        <translation>Ein Punkt, den die Werkzeuge des Sensors gemessen haben.</translation>
    </message>
    <message>
        <source>Which of the sensor&apos;s points, from 0.</source>
        <translation>Welcher der Punkte des Sensors, ab 0.</translation>
    </message>
    <message>
        <source>Noise of each coordinate (1 sigma).</source>
        <translation>Rauschen jeder Koordinate (1 Sigma).</translation>
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
        <source>step to show, 1 to 7</source>
        <translation>anzuzeigender Schritt, 1 bis 7</translation>
    </message>
    <message>
        <source>writes a picture of the window after 3 s and ends</source>
        <translation>schreibt nach 3 s ein Bild des Fensters und endet</translation>
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
        <translation>Einfahrt %1 mm, Ausfahrt %2 mm, Streuung ±%3 mm</translation>
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
        <translation>Weg (mm), Trigger bei 0</translation>
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
        <translation>Überlagerung</translation>
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
    <message>
        <source>%1 days old</source>
        <translation>%1 Tage alt</translation>
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
</context>
<context>
    <name>seamwright::CalibrationDesk</name>
    <message>
        <source>The chains before end in another reference: begin anew, or remove them.</source>
        <translation>Die Ketten davor enden in einem anderen Bezug: neu beginnen oder sie entfernen.</translation>
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
        <translation>jede außer gestoppt und Störung</translation>
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
        <source>Address, port, serial number and whatever else the driver documents</source>
        <translation>Adresse, Port, Seriennummer und was der Treiber sonst beschreibt</translation>
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
        <source>New name</source>
        <translation>Neuer Name</translation>
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
        <translation>Das Werkstückkoordinatensystem, mit dem neuen Roboter gemessen</translation>
    </message>
    <message>
        <source>Work object in the new robot&apos;s base</source>
        <translation>Werkstückkoordinaten in der Basis des neuen Roboters</translation>
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
        <source>Stops what runs; captures are kept</source>
        <translation>Hält an, was läuft; Aufnahmen bleiben erhalten</translation>
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
        <source>Moves the simulated robot to the next pose</source>
        <translation>Fährt den simulierten Roboter zur nächsten Pose</translation>
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
        <source>Unit</source>
        <translation>Einheit</translation>
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
        <source>Puts these captures aside, on disk, and begins with none</source>
        <translation>Legt diese Aufnahmen auf der Platte beiseite und beginnt ohne</translation>
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
    <message>
        <source>%1 captures, at least %2 are needed</source>
        <translation>%1 Aufnahmen, mindestens %2 werden gebraucht</translation>
    </message>
    <message>
        <source>%1 captures, %2 are better</source>
        <translation>%1 Aufnahmen, %2 sind besser</translation>
    </message>
    <message>
        <source>%1 captures</source>
        <translation>%1 Aufnahmen</translation>
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
    <name>seamwright::MainWindow</name>
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
        <source>No project is open.</source>
        <translation>Es ist kein Projekt offen.</translation>
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
        <translation>Macht ein zweites Projekt, wie aus der linken Tür die rechte wird: Messstellen, Merkmale, Korrekturbereiche und Frames werden an einer Ebene des Werkstückkoordinatensystems gespiegelt. Sensoren, Roboter und Kalibrierungen bleiben. Läufe und Nachweise bleiben bei diesem Projekt.</translation>
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
        <translation>Die Achse des Werkstückkoordinatensystems, zu der die Ebene quer steht</translation>
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
        <translation>Vom Ursprung der Werkstückkoordinaten, entlang dieser Achse</translation>
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
</context>
<context>
    <name>seamwright::PoseEditor</name>
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
        <translation>Helligkeit des Laserstrichs über x</translation>
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
        <translation>Bereich</translation>
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
        <source>Stated 3 sigma</source>
        <translation>Angabe 3 Sigma</translation>
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
</context>
<context>
    <name>seamwright::RegionsPage</name>
    <message>
        <source>A region is what moves as one piece: its spots tell where it has gone, its frame is what the robot gets.</source>
        <translation>Ein Korrekturbereich ist, was sich als ein Stück bewegt: seine Messstellen sagen, wohin; seinen Frame bekommt der Roboter.</translation>
    </message>
    <message>
        <source>Regions</source>
        <translation>Bereiche</translation>
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
        <source>New name</source>
        <translation>Neuer Name</translation>
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
        <translation>Bereich hinzufügen</translation>
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
        <translation>Verschiebung je Bereich mit Sigma, und was geschrieben wurde</translation>
    </message>
    <message>
        <source>%1, refused</source>
        <translation>%1, abgelehnt</translation>
    </message>
    <message>
        <source>Region, verdict</source>
        <translation>Bereich, Urteil</translation>
    </message>
</context>
<context>
    <name>seamwright::SceneView</name>
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
        <source>Drag turns, Shift and drag moves, wheel zooms, a click selects. 1 front, 2 top, 3 iso, F fit.</source>
        <translation>Ziehen dreht, Umschalt und Ziehen verschiebt, Rad zoomt, ein Klick wählt. 1 vorn, 2 oben, 3 iso, F einpassen.</translation>
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
        <translation>Bereiche</translation>
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
        <source>taught</source>
        <translation>eingelernt</translation>
    </message>
    <message>
        <source>taught, edge recorded</source>
        <translation>eingelernt, Kante aufgenommen</translation>
    </message>
    <message>
        <source>Spots (%1)</source>
        <translation>Messstellen (%1)</translation>
    </message>
    <message>
        <source>Regions (%1)</source>
        <translation>Korrekturbereiche (%1)</translation>
    </message>
    <message>
        <source>%1 spots</source>
        <translation>%1 Messstellen</translation>
    </message>
</context>
<context>
    <name>seamwright::StationWorker</name>
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
        <source>spot %1: no profile was seen on the whole pass</source>
        <translation>Messstelle %1: auf der ganzen Durchfahrt wurde kein Profil gesehen</translation>
    </message>
    <message>
        <source>Moving the simulated robot</source>
        <translation>Den simulierten Roboter fahren</translation>
    </message>
    <message>
        <source>only a simulated robot is moved from here</source>
        <translation>nur ein simulierter Roboter wird von hier gefahren</translation>
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
        <source>Moves the simulated robot to the spot; a real one is jogged</source>
        <translation>Fährt den simulierten Roboter zur Messstelle; ein echter wird von Hand verfahren</translation>
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
        <source>Click the reference point in the live profile; it need not lie on the contour</source>
        <translation>Den Referenzpunkt im laufenden Profil anklicken; er muss nicht auf der Kontur liegen</translation>
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
        <source>New name</source>
        <translation>Neuer Name</translation>
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
        <source>all within limits</source>
        <translation>alle innerhalb der Grenzen</translation>
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
</context>
</TS>
