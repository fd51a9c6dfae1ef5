<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>Checklist</name>
    <message>
        <source>add a sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>add a robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>connect the devices</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 sensors and %2 robots answer</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor %1 has no calibration in use</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>calibration %1 of sensor %2 is %3</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor %1 is another device (%2) than was calibrated (%3)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>there is no sensor to calibrate</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>every sensor has a calibration in use</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>measure the reference of spot %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>add a spot where the contour is to be measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 spots have their reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>record the pass of spot %1 and accept it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>there is no spot to align</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>the contour stands still at %1 spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>add a region and give it spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>region %1 has no spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>name the controller&apos;s frame of region %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>region %1: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>region %1 is under-determined: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>spot %1 belongs to no region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 regions are observable</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>measure the unmoved part %1 times: it must read zero</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>spots, regions or calibration were changed since the zero shift of %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>a zero-shift run was refused; see why and repeat</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 of %2 zero-shift runs</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 runs of the unmoved part read zero</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>measure the next part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>first: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cell</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Calibrate</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Teach</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Align</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Regions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Prove</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>done</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>next</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>waits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>stale</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>DeskCommand</name>
    <message>
        <source>spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>calibration</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Enable spot %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Disable spot %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Use calibration %1 at sensor %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename project to %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Add %1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Remove %1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename %1 %2 to %3</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Move %1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Change %1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Change %3 of %1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Import part %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Place the simulated part</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>RecoveryText</name>
    <message>
        <source>%1 %2 added</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 %2 changed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 %2 removed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>project renamed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>part changed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>order changed</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>main</name>
    <message>
        <source>Teach, align, prove and run robot path correction with laser-stripe sensors.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>project to open; without it the demo project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>en or de</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>light or dark</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>of the window, e.g. 1280x800</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>settings file instead of the user&apos;s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>folder for the demo project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>step to show, 1 to 7</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>writes a picture of the window after 3 s and ends</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::AlignPage</name>
    <message>
        <source>While the robot passes the spot along the contour, the profile should stand still. Then trigger jitter does no harm.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Step of the pass</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Travel between two profiles</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Tolerance</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Error that the trigger jitter may cause at most</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run entry -&gt; exit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The robot goes along the contour and stops at every step; nothing is written</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Accept</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Keeps jitter window and the contour&apos;s curve with the spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Adopt turned pose</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Turns the taught pose about the reference point by the rotation that cures it; teach again then</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>accepted earlier</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no pass recorded</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Entry %1 mm, exit %2 mm, jitter +-%3 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Choose a spot.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>FROZEN</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>SHAPE CHANGES</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>NOT ENOUGH PROFILES</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>yaw %1 deg, pitch %2 deg, radius %3, expected error %4 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>straight</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The feature was found in too few profiles to learn the contour&apos;s curve.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>To cure: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>alignment</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>pose</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::AlignView</name>
    <message>
        <source>Shift and turn against travel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>dx (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>dz (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>turn (°)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>travel (mm), trigger at 0</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run the robot from entry to exit: dx, dz and the turn of every profile against the one at the trigger appear here. A contour that stands still is flat.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Profiles over travel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>x (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>z (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>travel (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frozen contour</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Does the contour stand still while the robot passes the spot?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Drag either blue line, or press Left and Right: how far the trigger may miss</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>x to the right, travel upwards, height as colour: upright bands stand still</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Overlay</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>All profiles over each other; the live one thin over the frozen one</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Reason and cure</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Yaw</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>atan(dx/dy), sensor frame, ± sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Pitch</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>atan(dz/dy), sensor frame, ± sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Twist</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Turn of the profile over the jitter&apos;s half width</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Local radius</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Of the contour&apos;s own curvature along the travel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Error from jitter</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Largest shift within the jitter window</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Tolerance</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What the jitter may cause at most, and the window it was judged over</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Shape change</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What remains after the profiles are laid over each other</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>NOT RECORDED</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run the robot slowly from entry over the trigger to the exit.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>RECORDING</source>
        <translation type="unfinished"></translation>
    </message>
    <message numerus="yes">
        <source>%n profiles so far</source>
        <translation type="unfinished">
            <numerusform></numerusform>
            <numerusform></numerusform>
        </translation>
    </message>
    <message>
        <source>not seen</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>straight</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 m</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 mm / ±%2 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>FROZEN</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The contour stands still within the tolerance.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The jitter causes more than the tolerance.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>SHAPE CHANGES</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The profile changes its shape within the jitter: move the spot along the contour.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>TOO FEW PROFILES</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Fewer than 5 usable profiles, or less than 1 mm of travel: record the pass again, slower.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The profile is a straight line: only the drift across it is seen.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rotation that cures the drift</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Turn the sensor this way, seen along the axis towards the eye</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>about %1: %2%3°</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>about %1: none</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::CalibratePage</name>
    <message>
        <source>of unknown age</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>of today</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 days old</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>From pixels to millimetres on the flange. Each sensor uses one calibration; the others stay selectable.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A new calibration</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Copy the command</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Puts the command line into the clipboard: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera and laser plane</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Images of a board with the stripe across it, in 8 or more orientations.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensor on the flange</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cuts of one sphere from 9 or more orientations of the flange.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The project holds no calibration yet.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1: sensor %2 on robot %3</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Method %1. From: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>flange_from_sensor  X %1  Y %2  Z %3 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Made with device %1; connected is %2: pushes are refused.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>In use</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Use</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure with this calibration from now on</source>
        <translation type="unfinished"></translation>
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
</context>
<context>
    <name>seamwright::CameraView</name>
    <message>
        <source>No camera image yet.
This sensor sends finished profiles, or its raw image is switched off.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>saturated %1 px (%2 %)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not saturated, max %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The sensor&apos;s raw image with the peaks found. Drag moves, wheel zooms, F fits.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera image, pixels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera state</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Fit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Show the whole image (F)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Drag the region of interest</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Peaks</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Peaks: strongest blue, others purple</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Histogram</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Grey values, logarithmic, and saturated pixels</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::CellPage</name>
    <message>
        <source>Which sensors and robots there are, and which part they look at. Connect them here.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Connect</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Open all sensors and robots of the project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Disconnect</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Let go of all sensors and robots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensors and robots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Kind</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Driver</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>State</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensors and robots of the project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Give the device another name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Remove</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Take the device out of the project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Add sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A further sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Add robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A further robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>How the device is spoken to</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>any but stopped and fault</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Push only in mode</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Pushes are refused while the robot is in another mode</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Settings (JSON)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Address, port, serial number and whatever else the driver documents</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>refused: this is no JSON</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Apply</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Take driver and settings over; connect again afterwards</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>millimetre (checked)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>millimetre</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>metre</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Unit of the file</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>STL, PLY and OBJ do not say their unit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Import part...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Mesh of the part in the work object frame: STL, PLY or OBJ</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Work object in the robot&apos;s base</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>base_from_workobject: where the part as taught stands</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Change the work object&apos;s frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Simulated part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Puts the next part into the simulated fixture: up to 10 mm and 0.6 degrees off, a little bent. Or the taught one again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Displace</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The next simulated part, displaced</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>As taught</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The simulated part where it was taught</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not connected</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ok, %1 frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no frame: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ok, %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>silent: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>No mesh. Everything works without one; the 3D view is empty then.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1, from %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>never connected</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>answers as %1, serial %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Exposure and trigger of sensor %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>New name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>settings</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Import part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Meshes (*.stl *.ply *.obj)</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::CommandPalette</name>
    <message>
        <source>All actions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Type a few letters</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Search actions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Letters in order; Enter runs the marked action</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Actions found</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Enter or double click runs an action</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::EventList</name>
    <message>
        <source>Event log</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What happened, newest first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>When</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Kind</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Subject</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Text</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>note</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>refusal</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>push attempt</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>push</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ALARM</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>device</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::Histogram</name>
    <message>
        <source>fewer than two values</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>n %1   mean %2   s %3 %4</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cp %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cpk %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>(few values)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Distribution</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Distribution with limits. Cp and Cpk assume independent values of one stable, normal process.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Distribution in numbers</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Distribution chart</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::MainWindow</name>
    <message>
        <source>autosaved %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>saved</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;File</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;New project...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Open...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Recent</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Save</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Save &amp;as...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Import project (JSON)...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Export project (JSON)...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Open the demo project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Start the demo project anew</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Demo project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Replace your demo project and its runs by a fresh one?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Edit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Undo</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Redo</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>All actions...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Steps</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Step %1: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Go to the next step</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;Measure</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Connect devices</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Disconnect devices</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure, then push...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cancel the measuring</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Show %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>One view alone, and back</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Freeze the live profile, and go on</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Docks as at first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Deutsch</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Light theme</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Dark theme</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Tools</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>More</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>This view alone, and back (F11)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>In a window of its own, and back</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Live profile</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Part in 3D</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frozen contour</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Residuals</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Charts</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Events</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Understood</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Puts the message away; the event log keeps it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensors: state, rate, dropped frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Robots: mode and state</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The last push</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Alarms and refusals in the event log</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Whether edits are saved</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1[*] - Seamwright</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Next: %1 - %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor %1 ok %2 /s, %3 dropped</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor %1 no frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>robot %1 %2 ok</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>robot %1 silent</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not connected</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>last push %1, run %2 verified</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>nothing pushed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Unsaved edits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 has unsaved edits.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>New project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Seamwright projects (*.seam)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Open project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Save as</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Export project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>JSON (*.json)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Import project</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 is no JSON</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Save the imported project as</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::ParameterEditor</name>
    <message>
        <source>%1 to %2 %3</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Why the value is refused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not a number</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>outside %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::PoseEditor</name>
    <message>
        <source>mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>rad</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 in %2. A whole pose can be pasted here.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>refused: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Pose</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Position in mm and orientation in the notation chosen</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Notation of the orientation</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>How the orientation is written; the pose itself stays</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Matrix, 4 rows of 4 numbers, mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Paste or type 12 or 16 numbers, row by row; Ctrl+Enter takes them</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Why the pose is refused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>a pose of %1 numbers</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>give 6 numbers, 7 with a quaternion, 12 or 16 as a matrix</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>KUKA A B C (Z-Y&apos;-X&apos;&apos;)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>FANUC W P R</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ABB quaternion (w first)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>UR rotation vector</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Matrix 4 x 4</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::ProfilePlot</name>
    <message>
        <source>x (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>z (mm)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>intensity, up to %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>x %1 ± %2   z %3 ± %4 mm (2 sigma)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no feature: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 mm   %2°   (dx %3, dz %4)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>residuals:
no reference here</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>to reference %1 ± %2 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Live profile</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Profile in the sensor frame, mm. Drag moves, wheel zooms, double click or F fits, Space freezes, M measures.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Profile, x and z in mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensor state</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Fit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Show all points (F)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Two clicks: distance and angle (M)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Residuals</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Histogram of the distances to the reference profile</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Intensity</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Brightness of the stripe along x</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Freeze</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Hold this profile on the screen (Space)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frozen</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::ProvePage</name>
    <message>
        <source>Before anything is corrected: the part as taught, not touched, measured several times. Every number must be zero within its scatter.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Runs</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>How often the unmoved part is measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Start zero shift</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measures; nothing is written to the robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The region that the table and the charts show</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Direction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Mean</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Stated 3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Mean and scatter over the zero-shift runs</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The mean tells bias, 3 sigma the repeatability; stated is what the correction itself claims. The charts beside show every run.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Y</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A about Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>B about Y</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>C about X</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not measured yet</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 of %2 runs were refused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 runs: the mean is off zero by more than 3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 runs read zero within 3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Zero shift of region %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Zero shift, X Y Z</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::RegionsPage</name>
    <message>
        <source>A region is what moves as one piece: its spots tell where it has gone, its frame is what the robot gets.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Regions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The project&apos;s regions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Another name for the region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>New name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Remove</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Take the region out; its spots stay</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Add region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A further region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Direction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Free</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Predicted 3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What the region will be able to tell</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spots of the region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Ticked spots belong to the region; a spot may belong to several</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Free degrees of freedom (work object)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Y</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A about Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>B about Y</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>C about X</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Ticked: the correction may move this way. Not ticked: exactly 0</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>degrees of freedom</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frame on the controller</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>As the controller calls the base or work object that the path runs in</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frame as taught</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>base_from_frame for the undisplaced part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Limits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>observable; weakest: %1, sigma %2 mm at the spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>under-determined: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>yes</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>exactly 0</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not observed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A wrong measure of %1 mm could not be found at: %2</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::ResidualBars</name>
    <message>
        <source>x</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>left out</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1
left out</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>residual (mm), box 3 sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Residuals per spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What the correction leaves at each spot along the sensor&apos;s x and z. A click selects the spot.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Residual chart</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::RunPage</name>
    <message>
        <source>ok</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>refused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ALARM</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>device failed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>cancelled</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>interrupted</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure the part, look at the result, push the corrected frames.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>run number</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Identity of the part that stands there; empty: the run&apos;s number</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Keep raw images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Camera images are stored with the run, beside the profiles</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measures and judges; nothing is written to the robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure, then push...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measures, shows what would be written, and asks before it is pushed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X Y Z mm  A B C deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What would be written, and what stands there</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Push</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Writes these frames to the robot, reads them back and compares</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Do not push</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Nothing is written; the run is kept</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Y mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Z mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>B deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>C deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Displacement per region with its sigma</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>dx mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>dz mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Why</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What every spot measured against its reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>History</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>When</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Status</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>All runs of the project, newest first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Show</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Shows the chosen run above (Enter, double click)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Compare</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The chosen run beside the one shown above</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Export CSV...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>All runs: one line a region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Delete...</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Deletes the chosen run with its raw data</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Delete run</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Delete run %1 with its raw data? This cannot be undone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Difference X Y Z mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A B C deg</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Second run minus first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Nothing was measured yet.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run %1, part %2: %3. %4</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>passed the gate</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>, refused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 ± %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>not solved</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Safety gate: every region passes.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Safety gate refuses: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 now</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 new</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>These frames would be written. Nothing has been sent yet.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Push %1 frames to %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>ok, pushed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>X</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Y</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Displacement of region %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Displacement, X Y Z</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Run %1 - %2: X Y Z mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Export CSV</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>CSV (*.csv)</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::SceneView</name>
    <message>
        <source>%1 (off)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>  %1 mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>corrections drawn × %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Part in 3D</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Drag turns, Shift and drag moves, wheel zooms, a click selects. 1 front, 2 top, 3 iso, F fit.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Part</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Front</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Top</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Iso</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Fit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>View: %1</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Layers</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>What is drawn</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensors and laser planes</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Regions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Corrections</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Path before and after</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Labels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>No 3D picture: this display offers no OpenGL 3.2. Everything else works; measuring, correcting and pushing do not need it. Cure: a graphics driver with OpenGL 3.2, or Mesa&apos;s software renderer (LIBGL_ALWAYS_SOFTWARE=1).</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::SpotTree</name>
    <message>
        <source>Spots and regions</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spots in the order of measuring, and regions with their spots</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spot / region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>State</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>disabled</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>taught</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>taught, aligned</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spots (%1)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Regions (%1)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1 spots</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::StationWorker</name>
    <message>
        <source>Connecting</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Disconnecting</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measuring</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Zero shift</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>run %1 of %2: %3</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Teaching</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Recording the pass</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>spot %1: no profile was seen on the whole pass</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Moving the simulated robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>only a simulated robot is moved from here</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Setting the sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor %1 is not connected</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::StepPage</name>
    <message>
        <source>%1: %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Progress</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>How far the measuring is</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Stop the measuring; nothing is pushed</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::StepRail</name>
    <message>
        <source>%1 %2</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>next, stale</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>%1: %2. %3</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::Studio</name>
    <message>
        <source>Restore unsaved edits?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The last session ended without saving. Its edits of %1 are still there:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>
and %1 more</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Restore</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Open as saved</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The edits come back; save keeps them</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The edits are thrown away</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::TeachPage</name>
    <message>
        <source>Jog the sensor over the contour, take the pose, point at the feature, measure its reference.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Duplicate</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The same spot once more</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Another name for the spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Up</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure it one earlier</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Down</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure it one later</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Remove</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Take the spot out; undo brings it back</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Add spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A new spot at the robot&apos;s present pose</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Enabled</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>A disabled spot is not measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Required</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Nothing is pushed when a required spot was not measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>required</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Pose of the flange at the trigger</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>base_from_flange, in the notation of the robot&apos;s brand; paste a whole pose into any field</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>pose</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Take from the robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The pose where the robot stands now</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Go there</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Moves the simulated robot to the spot; a real one is jogged</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The sensor that looks at the spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The robot that carries the sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>sensor</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>robot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Feature of the contour</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Kind</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Which point of the contour is measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Point at it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Click the contour in the live profile, where the feature is</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Drag template</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Drag a window in the live profile: the contour inside becomes the template</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Reference by click</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Click the reference point in the live profile; it need not lie on the contour</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Repeats</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>How often the reference is measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Measure reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>The robot stands still at the spot and measures; mean and spread are shown</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Pass, weights and noise</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>reference point</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>reference</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Spread of %1 measurements: x %2 mm, z %3 mm (1 sigma); %4 left out</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Not measured yet.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>x %1   z %2 mm in the sensor; %3 points of contour kept</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Rename spot</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>New name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>feature</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>template</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::TrendChart</name>
    <message>
        <source>lower limit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>upper limit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>no parts yet</source>
        <translation type="unfinished"></translation>
    </message>
    <message numerus="yes">
        <source>%n beyond limits</source>
        <translation type="unfinished">
            <numerusform></numerusform>
            <numerusform></numerusform>
        </translation>
    </message>
    <message>
        <source>all within limits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>History over parts</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>One mark per part. A click opens the part; Left and Right move, Enter opens.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>Chart title</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <source>History chart</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>seamwright::ViewFeeder</name>
    <message>
        <source>sensor %1   %2 /s   %3 dropped</source>
        <translation type="unfinished"></translation>
    </message>
</context>
</TS>
