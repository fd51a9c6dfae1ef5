#include "widgets/errors.h"

#include <QCoreApplication>
#include <QRegularExpression>
#include <array>
#include <vector>

namespace seamwright {
namespace {

// As they are written below, with %1 to %4 where they have names and numbers.
constexpr auto kCauses = std::to_array<const char*>({
    // files
    QT_TRANSLATE_NOOP("Errors", "the file does not exist"),
    QT_TRANSLATE_NOOP("Errors", "the file exists already"),
    QT_TRANSLATE_NOOP("Errors", "the file exists and is no project file"),
    QT_TRANSLATE_NOOP("Errors", "the file is empty"),
    QT_TRANSLATE_NOOP("Errors", "the folder does not exist"),
    QT_TRANSLATE_NOOP("Errors", "this is a folder"),
    QT_TRANSLATE_NOOP("Errors", "this is no file"),
    QT_TRANSLATE_NOOP("Errors", "is no file"),
    QT_TRANSLATE_NOOP("Errors", "the file cannot be made (%1)"),
    QT_TRANSLATE_NOOP("Errors", "the file cannot be replaced: %1"),
    QT_TRANSLATE_NOOP("Errors", "another program works with the file"),
    QT_TRANSLATE_NOOP("Errors", "the project is open already (%1, process %2 on %3, since %4)"),
    QT_TRANSLATE_NOOP("Errors",
                      "the devices of the project are in use already (%1, process %2 on %3, since %4)"),
    QT_TRANSLATE_NOOP("Errors", "go on there, or close it there first"),
    QT_TRANSLATE_NOOP("Errors", "disconnect them there, or end it, first"),
    QT_TRANSLATE_NOOP("Errors", "the project file could not be brought up to date"),
    QT_TRANSLATE_NOOP("Errors", "cannot be written"),
    QT_TRANSLATE_NOOP("Errors", "choose a folder that you may write to"),
    QT_TRANSLATE_NOOP("Errors", "choose another name"),
    QT_TRANSLATE_NOOP("Errors", "choose a .seam file"),
    QT_TRANSLATE_NOOP("Errors", "close it there or choose another name"),
    QT_TRANSLATE_NOOP("Errors", "make it first"),
    QT_TRANSLATE_NOOP("Errors", "name a file"),
    QT_TRANSLATE_NOOP("Errors", "cannot be read (%1)"),
    QT_TRANSLATE_NOOP("Errors", "holds no readable triangles"),
    QT_TRANSLATE_NOOP("Errors", "is neither .stl, .ply nor .obj"),
    QT_TRANSLATE_NOOP("Errors", "the part is only %1 long: metres suspected"),
    QT_TRANSLATE_NOOP("Errors", "say the unit: \"mm\" or \"m\""),
    QT_TRANSLATE_NOOP("Errors", "no project is open"),
    QT_TRANSLATE_NOOP("Errors", "open or make one"),
    // connecting
    QT_TRANSLATE_NOOP("Errors", "no answer in time"),
    QT_TRANSLATE_NOOP("Errors", "no answer in time: no frame within %1 ms"),
    QT_TRANSLATE_NOOP("Errors", "no answer in time: no trigger within %1 ms"),
    QT_TRANSLATE_NOOP("Errors", "no answer in time: the next attempt to connect is in %1 ms"),
    QT_TRANSLATE_NOOP("Errors", "the connection was closed by the other side"),
    QT_TRANSLATE_NOOP("Errors", "the connection is closed"),
    QT_TRANSLATE_NOOP("Errors", "check the cable and the controller"),
    QT_TRANSLATE_NOOP("Errors", "check that the controller runs and its program is started"),
    QT_TRANSLATE_NOOP("Errors", "nobody connected"),
    QT_TRANSLATE_NOOP("Errors", "another program may use this port"),
    QT_TRANSLATE_NOOP("Errors", "cannot listen: %1"),
    QT_TRANSLATE_NOOP("Errors", "the station is not connected to its devices"),
    QT_TRANSLATE_NOOP("Errors", "its sensor or robot is not connected"),
    QT_TRANSLATE_NOOP("Errors", "connect first"),
    QT_TRANSLATE_NOOP("Errors", "the recording has ended"),
    QT_TRANSLATE_NOOP("Errors", "the driver \"%1\" is not known"),
    // robots
    QT_TRANSLATE_NOOP("Errors", "the robot is stopped"),
    QT_TRANSLATE_NOOP("Errors", "start it on its controller"),
    QT_TRANSLATE_NOOP("Errors", "the robot has not moved anywhere yet"),
    QT_TRANSLATE_NOOP("Errors", "move the robot first"),
    QT_TRANSLATE_NOOP("Errors", "the robot stands %1 mm and %2 deg off the pose to teach at (%3)"),
    QT_TRANSLATE_NOOP("Errors", "jog it there"),
    QT_TRANSLATE_NOOP("Errors", "this robot cannot be moved from the program"),
    QT_TRANSLATE_NOOP("Errors", "move it by hand and read its position"),
    QT_TRANSLATE_NOOP("Errors", "the controller has no frame \"%1\""),
    QT_TRANSLATE_NOOP("Errors", "give it in the settings under robot.frames"),
    QT_TRANSLATE_NOOP("Errors", "the controller holds no measuring program"),
    QT_TRANSLATE_NOOP("Errors", "load the program that was generated from the project"),
    QT_TRANSLATE_NOOP("Errors", "the measuring program has ended"),
    QT_TRANSLATE_NOOP("Errors", "the robot fired for spot \"%1\", which is measured already"),
    QT_TRANSLATE_NOOP("Errors", "the robot fired for spot \"%1\", which is not in the measuring program"),
    QT_TRANSLATE_NOOP("Errors", "compare the program on the controller with the project"),
    QT_TRANSLATE_NOOP("Errors", "check the trigger line between robot and sensor"),
    QT_TRANSLATE_NOOP("Errors", "the sensor exposed more often than the robot fired"),
    // sensors, teaching, measuring
    QT_TRANSLATE_NOOP("Errors", "the sensor gave no frame"),
    QT_TRANSLATE_NOOP("Errors", "the sensor is not started"),
    QT_TRANSLATE_NOOP("Errors", "let the robot measure or trigger the sensor"),
    QT_TRANSLATE_NOOP("Errors", "cancelled"),
    QT_TRANSLATE_NOOP("Errors", "a measurement is running"),
    QT_TRANSLATE_NOOP("Errors", "wait for its end or cancel it"),
    QT_TRANSLATE_NOOP("Errors", "no spot is enabled"),
    QT_TRANSLATE_NOOP("Errors", "teach a spot first"),
    QT_TRANSLATE_NOOP("Errors", "the feature was found in %1 of %2 measurements (%3)"),
    QT_TRANSLATE_NOOP("Errors", "choose another feature or move the sensor"),
    QT_TRANSLATE_NOOP("Errors", "only %1 of %2 measurements agree"),
    QT_TRANSLATE_NOOP("Errors", "choose another feature, shield reflections or move the sensor"),
    // editing
    QT_TRANSLATE_NOOP("Errors", "a spot needs a sensor and a robot"),
    QT_TRANSLATE_NOOP("Errors", "add them first"),
    QT_TRANSLATE_NOOP("Errors", "the name is empty"),
    QT_TRANSLATE_NOOP("Errors", "give it a name"),
    QT_TRANSLATE_NOOP("Errors", "the name is longer than 64 signs"),
    QT_TRANSLATE_NOOP("Errors", "shorten it"),
    QT_TRANSLATE_NOOP("Errors", "the sensor \"%1\" is not in the project"),
    QT_TRANSLATE_NOOP("Errors", "the robot \"%1\" is not in the project"),
    QT_TRANSLATE_NOOP("Errors", "its sensor \"%1\" is not in the project"),
    QT_TRANSLATE_NOOP("Errors", "choose one of the project's"),
    QT_TRANSLATE_NOOP("Errors", "choose one of the project's sensors"),
    QT_TRANSLATE_NOOP("Errors", "there is no spot \"%1\""),
    QT_TRANSLATE_NOOP("Errors", "no degree of freedom is free"),
    QT_TRANSLATE_NOOP("Errors", "leave at least one free"),
    QT_TRANSLATE_NOOP("Errors", "spot %1 uses it"),
    QT_TRANSLATE_NOOP("Errors", "give the spot another sensor first"),
    QT_TRANSLATE_NOOP("Errors", "give the spot another robot first"),
});

QString translated(const char* english) {
    return QCoreApplication::translate("Errors", english);
}

struct Pattern {
    const char* english;
    QRegularExpression shape;
};

const std::vector<Pattern>& patterns() {
    static const std::vector<Pattern> made = [] {
        std::vector<Pattern> list;
        static const QRegularExpression gap(QStringLiteral(R"(\\%[1-9])"));
        for (const char* cause : kCauses) {
            QString shape = QRegularExpression::escape(QString::fromUtf8(cause));
            shape.replace(gap, QStringLiteral("(.*)"));
            list.push_back({cause, QRegularExpression(QRegularExpression::anchoredPattern(shape),
                                                      QRegularExpression::DotMatchesEverythingOption)});
        }
        return list;
    }();
    return made;
}

}  // namespace

QString shown_cause(const std::string& english) {
    const QString text = QString::fromStdString(english);
    for (const Pattern& pattern : patterns()) {
        const auto match = pattern.shape.match(text);
        if (!match.hasMatch()) continue;
        QString shown = translated(pattern.english);
        for (int i = match.lastCapturedIndex(); i >= 1; --i)
            shown.replace(QStringLiteral("%") + QString::number(i), match.captured(i));
        return shown;
    }
    return text;
}

QString shown_error(const Error& error) {
    QString text;
    if (!error.where.empty()) text = QString::fromStdString(error.where) + QStringLiteral(": ");
    text += shown_cause(error.what);
    if (!error.mend.empty()) text += QStringLiteral("; ") + shown_cause(error.mend);
    return text;
}

QString shown_error(const QString& frame, const Error& error) {
    return frame + QStringLiteral(" ") + shown_error(error);
}

}  // namespace seamwright
