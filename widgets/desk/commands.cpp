#include "widgets/desk/commands.h"

namespace seamwright {

template <>
std::vector<Spot>& list_of<Spot>(Project& p) {
    return p.spots;
}
template <>
std::vector<Region>& list_of<Region>(Project& p) {
    return p.regions;
}
template <>
std::vector<SensorSetup>& list_of<SensorSetup>(Project& p) {
    return p.sensors;
}
template <>
std::vector<RobotSetup>& list_of<RobotSetup>(Project& p) {
    return p.robots;
}
template <>
std::vector<Calibration>& list_of<Calibration>(Project& p) {
    return p.calibrations;
}

template <>
QString thing_name<Spot>() {
    return QCoreApplication::translate("DeskCommand", "spot");
}
template <>
QString thing_name<Region>() {
    return QCoreApplication::translate("DeskCommand", "region");
}
template <>
QString thing_name<SensorSetup>() {
    return QCoreApplication::translate("DeskCommand", "sensor");
}
template <>
QString thing_name<RobotSetup>() {
    return QCoreApplication::translate("DeskCommand", "robot");
}
template <>
QString thing_name<Calibration>() {
    return QCoreApplication::translate("DeskCommand", "calibration");
}

std::vector<std::string*> references(Project& project, const Spot*) {
    std::vector<std::string*> all;
    for (Region& region : project.regions)
        for (std::string& id : region.spot_ids) all.push_back(&id);
    return all;
}
std::vector<std::string*> references(Project&, const Region*) {
    return {};
}
std::vector<std::string*> references(Project& project, const SensorSetup*) {
    std::vector<std::string*> all;
    for (Spot& spot : project.spots) all.push_back(&spot.sensor_id);
    for (Calibration& calibration : project.calibrations) all.push_back(&calibration.sensor_id);
    return all;
}
std::vector<std::string*> references(Project& project, const RobotSetup*) {
    std::vector<std::string*> all;
    for (Spot& spot : project.spots) all.push_back(&spot.robot_id);
    for (Calibration& calibration : project.calibrations) all.push_back(&calibration.robot_id);
    return all;
}

CmdSpotEnable::CmdSpotEnable(Editor editor, const std::string& id, std::size_t at, bool enabled)
    : DeskCommand(std::move(editor)), at_(at), enabled_(enabled) {
    const QString name = QString::fromStdString(id);
    setText(enabled ? DeskCommand::tr("Enable spot %1").arg(name)
                    : DeskCommand::tr("Disable spot %1").arg(name));
}

CmdCalibrationUse::CmdCalibrationUse(Editor editor, const SensorSetup& sensor, std::size_t at,
                                     std::string calibration_id)
    : DeskCommand(std::move(editor)),
      at_(at),
      before_(sensor.calibration_id),
      after_(std::move(calibration_id)) {
    setText(DeskCommand::tr("Use calibration %1 at sensor %2")
                .arg(QString::fromStdString(after_), QString::fromStdString(sensor.id)));
}

CmdPartEdit::CmdPartEdit(Editor editor, PartSetup before, PartSetup after, const QString& text)
    : DeskCommand(std::move(editor)), before_(std::move(before)), after_(std::move(after)) {
    setText(text);
}

CmdRequirementsEdit::CmdRequirementsEdit(Editor editor, const Requirements& before, const Requirements& after)
    : DeskCommand(std::move(editor)), before_(before), after_(after) {
    setText(DeskCommand::tr("Change the requirements"));
}

CmdProjectRename::CmdProjectRename(Editor editor, std::string before, std::string after)
    : DeskCommand(std::move(editor)), before_(std::move(before)), after_(std::move(after)) {
    setText(DeskCommand::tr("Rename project to %1").arg(QString::fromStdString(after_)));
}

}  // namespace seamwright
