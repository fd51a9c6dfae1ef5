#include "app/studio/dialogs/reuse_dialogs.h"

#include <QVBoxLayout>
#include <algorithm>

#include "projects/measure/measure.h"
#include "widgets/editors/number_box.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kDialogWidth = 460;

}  // namespace

MirrorDialog::MirrorDialog(QWidget* parent) : QDialog(parent) {
    setObjectName("mirror_dialog");
    setWindowTitle(tr("Clone for the mirrored part"));
    setMinimumWidth(kDialogWidth);
    auto* box = new QVBoxLayout(this);
    box->addWidget(
        make_text(tr("Makes a second project, as the left door becomes the right one: spots, features, "
                     "regions and frames are "
                     "reflected in a plane of the work object. Sensors, robots and calibrations stay. Runs "
                     "and proofs stay with "
                     "this project.")));
    axis_ = new QComboBox;
    axis_->setObjectName("mirror_axis");
    axis_->addItems({tr("X changes its sign"), tr("Y changes its sign"), tr("Z changes its sign")});
    axis_->setCurrentIndex(1);
    add_field(*box, tr("Plane"), axis_, tr("The axis of the work object that the plane stands across"));
    offset_ = new NumberBox;
    offset_->setObjectName("mirror_offset");
    offset_->setDecimals(3);
    offset_->setRange(-1e5, 1e5);
    offset_->setSuffix(tr(" mm"));
    add_field(*box, tr("Its distance"), offset_, tr("From the work object's origin, along that axis"));
    auto* row = make_row(
        {make_button("mirror_ok", "check", tr("Make the clone"), tr("Asks for its file"),
                     [this] { accept(); }),
         make_button("mirror_cancel", "stop", tr("Cancel"), tr("Nothing is made"), [this] { reject(); })});
    box->addLayout(row);
}

MirrorPlane MirrorDialog::plane() const {
    return {Eigen::Vector3d::Unit(axis_->currentIndex()), offset_->value()};
}

ExchangeDialog::ExchangeDialog(const Project& project, QWidget* parent) : QDialog(parent), project_(project) {
    setObjectName("exchange_dialog");
    setWindowTitle(tr("After an exchange of sensor or robot"));
    setMinimumWidth(kDialogWidth);
    auto* box = new QVBoxLayout(this);
    box->addWidget(
        make_text(tr("Only the calibration was repeated. Every spot's flange pose is led so that the sensor "
                     "stands at the part "
                     "where it stood before; references, features and regions stay as taught.")));
    sensor_ = new QComboBox;
    sensor_->setObjectName("exchange_sensor");
    for (const SensorSetup& s : project_.sensors) sensor_->addItem(QString::fromStdString(s.id));
    add_field(*box, tr("Sensor"), sensor_, tr("Whose spots are led along"));
    calibration_ = new QComboBox;
    calibration_->setObjectName("exchange_calibration");
    add_field(*box, tr("New calibration"), calibration_, tr("Made after the exchange; it comes into use"));
    robot_ = new QCheckBox(tr("The robot was exchanged or moved; the part stands in its base at:"));
    robot_->setObjectName("exchange_robot");
    robot_->setMinimumHeight(style::kTargetPx);
    robot_->setToolTip(tr("Give the work object as measured with the new robot"));
    box->addWidget(robot_);
    workobject_ = new PoseEditor;
    workobject_->setObjectName("exchange_workobject");
    workobject_->setAccessibleName(tr("Work object in the new robot's base"));
    workobject_->setToolTip(tr("base_from_workobject, measured with the new robot"));
    workobject_->set_pose(project_.part.base_from_workobject);
    workobject_->setEnabled(false);
    box->addWidget(workobject_);
    outcome_ = make_text({});
    outcome_->setObjectName("exchange_outcome");
    box->addWidget(outcome_);
    apply_ = make_button("exchange_ok", "check", tr("Lead the spots along"), tr("One step; can be undone"),
                         [this] { accept(); });
    box->addLayout(make_row({apply_, make_button("exchange_cancel", "stop", tr("Cancel"),
                                                 tr("Nothing is changed"), [this] { reject(); })}));
    connect(sensor_, &QComboBox::currentTextChanged, this, [this] { fill_calibrations(); });
    connect(calibration_, &QComboBox::currentTextChanged, this, [this] { preview(); });
    connect(robot_, &QCheckBox::toggled, this, [this](bool on) {
        workobject_->setEnabled(on);
        preview();
    });
    connect(workobject_, &PoseEditor::committed, this, [this] { preview(); });
    fill_calibrations();
}

void ExchangeDialog::fill_calibrations() {
    calibration_->clear();
    const SensorSetup* sensor = find_sensor(project_, sensor_->currentText().toStdString());
    if (!sensor) return preview();
    // The newest first.
    for (auto c = project_.calibrations.rbegin(); c != project_.calibrations.rend(); ++c)
        if (c->sensor_id == sensor->id && c->id != sensor->calibration_id)
            calibration_->addItem(QString::fromStdString(c->id));
    if (!sensor->calibration_id.empty())
        calibration_->addItem(QString::fromStdString(sensor->calibration_id));
    preview();
}

Exchange ExchangeDialog::exchange() const {
    Exchange e;
    e.sensor_id = sensor_->currentText().toStdString();
    e.calibration_id = calibration_->currentText().toStdString();
    if (robot_->isChecked()) e.base_from_workobject = workobject_->pose();
    return e;
}

void ExchangeDialog::preview() {
    const auto retaught = after_exchange(project_, exchange());
    apply_->setEnabled(retaught.has_value());
    if (!retaught) return set_verdict(*outcome_, shown_error(retaught.error()), Tone::attention);
    double mm = 0, deg = 0;
    for (const MovedSpot& s : retaught->spots)
        mm = std::max(mm, s.moved_mm), deg = std::max(deg, s.turned_deg);
    set_verdict(*outcome_,
                tr("%1 spots; a flange pose moves by %2 mm and %3 deg at most")
                    .arg(retaught->spots.size())
                    .arg(number(mm, 3), number(deg, 4)),
                Tone::plain);
}

}  // namespace seamwright
