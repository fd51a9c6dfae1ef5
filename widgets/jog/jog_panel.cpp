#include "widgets/jog/jog_panel.h"

#include <QFocusEvent>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QVBoxLayout>

#include "core/geometry/notation.h"
#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr std::chrono::milliseconds kPeriod{50};
constexpr double kMostSpeed_mm_s = 50;    // a person beside the robot can still step back
constexpr double kTurn_deg_per_mm = 0.2;  // a turn at the same speed: 50 mm/s are 10 degrees a second
constexpr double kLongestGap_s = 0.2;     // of the timer, beyond which the motion would jump

// What counts as where the robot was sent.
constexpr double kArrived_mm = 0.02, kArrived_rad = 1e-4;
// A place that was not reached for so long is no longer where the next step starts.
constexpr std::chrono::seconds kForgotten{3};

struct JogStep {
    double mm, deg;
};
constexpr std::array<JogStep, 6> kJogSteps{{{0.1, 0.1}, {0.5, 0.1}, {1, 0.5}, {5, 1}, {10, 2}, {50, 10}}};
constexpr int kFirstStep = 2;
constexpr int kTwoColumns_px = 600;  // of the panel: names, and words of a choice, side by side

}  // namespace

JogPanel::JogPanel(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk) {
    setObjectName("jog_panel");
    setAccessibleName(tr("Robot"));
    setToolTip(tr("The robot that is moved"));
    setFocusPolicy(Qt::StrongFocus);
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(8, 2, 8, 2);
    box->setSpacing(4);
    asked_ = make_text({});
    asked_->setObjectName("jog_asked");
    asked_->hide();
    box->addWidget(asked_);
    make_choices();
    make_keys();
    place_ = make_text({});
    place_->setObjectName("jog_place");
    place_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    box->addWidget(place_);
    message_ = make_text({});
    message_->setObjectName("jog_message");
    message_->hide();
    message_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    box->addWidget(message_);
    box->addStretch(1);

    timer_.setInterval(kPeriod);
    connect(&timer_, &QTimer::timeout, this, &JogPanel::advance);
    connect(&desk_, &Desk::station_changed, this, &JogPanel::refresh);
    connect(&desk_, &Desk::attended_changed, this, &JogPanel::refresh);
    connect(&desk_, &Desk::attendance_wanted, this, &JogPanel::ask_for);
    connect(&desk_, &Desk::opened, this, [this] {
        target_.reset();
        refresh();
    });
    connect(&desk_.worker(), &StationWorker::jogged, this, &JogPanel::moved);
    refresh();
}

void JogPanel::resizeEvent(QResizeEvent* event) {
    columns_->setDirection(width() < kTwoColumns_px ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
    QWidget::resizeEvent(event);
}

void JogPanel::make_choices() {
    columns_ = new QHBoxLayout;
    auto *left = new QVBoxLayout, *right = new QVBoxLayout;
    columns_->addLayout(left, 1);
    columns_->addLayout(right, 1);
    static_cast<QVBoxLayout&>(*layout()).addLayout(columns_);
    robot_ = new QComboBox;
    robot_->setObjectName("jog_robot");
    add_field(*left, tr("Robot"), robot_, tr("The robot that is moved"));
    consent_ = new QCheckBox(tr("Somebody stands beside the robot"));
    consent_->setObjectName("jog_consent");
    consent_->setToolTip(
        tr("A real robot moves from here only after this was said; asked again after every connection"));
    consent_->setMinimumHeight(style::kTargetPx);
    right->addWidget(consent_);
    frame_ = new QComboBox;
    frame_->setObjectName("jog_frame");
    frame_->addItem(tr("Sensor"), static_cast<int>(JogFrame::sensor));
    frame_->addItem(tr("Flange"), static_cast<int>(JogFrame::flange));
    frame_->addItem(tr("Robot's base"), static_cast<int>(JogFrame::base));
    add_field(*right, tr("Axes of"), frame_, tr("Along and about whose axes the keys move"));
    way_ = new QComboBox;
    way_->setObjectName("jog_way");
    way_->addItem(tr("One step a press"));
    way_->addItem(tr("As long as pressed"));
    add_field(*left, tr("Way"), way_, tr("What one press of a key does"));
    step_ = new QComboBox;
    step_->setObjectName("jog_step");
    for (const JogStep& s : kJogSteps)
        step_->addItem(tr("%1 mm, %2°").arg(locale().toString(s.mm), locale().toString(s.deg)));
    step_->setCurrentIndex(kFirstStep);
    add_field(*right, tr("Step"), step_, tr("How far one press moves and turns"));
    speed_ = new QDoubleSpinBox;
    speed_->setObjectName("jog_speed");
    speed_->setRange(1, kMostSpeed_mm_s);
    speed_->setDecimals(0);
    speed_->setValue(10);
    speed_->setSuffix(tr(" mm/s"));
    add_field(*left, tr("Speed"), speed_,
              tr("While a key is pressed; turns go at a fifth of it in degrees a second"));
    for (QComboBox* b : {robot_, frame_, way_, step_}) {  // beside each other in half a small screen
        b->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        b->setMinimumContentsLength(6);
    }
    connect(way_, &QComboBox::currentIndexChanged, this, &JogPanel::refresh);
    connect(robot_, &QComboBox::currentIndexChanged, this, [this] {
        target_.reset();
        desk_.attend(robot(), false);
        refresh();
    });
    connect(consent_, &QCheckBox::toggled, this, [this](bool on) { desk_.attend(robot(), on); });
}

void JogPanel::make_keys() {
    auto* grid = new QGridLayout;
    const std::array<QString, 6> names{tr("along X"), tr("along Y"), tr("along Z"),
                                       tr("about X"), tr("about Y"), tr("about Z")};
    const std::array<QString, 6> short_names{"X", "Y", "Z", "Rx", "Ry", "Rz"};
    for (int axis = 0; axis < 6; ++axis)
        for (const int way : {0, 1}) {
            Key& key = keys_[static_cast<std::size_t>(2 * axis + way)];
            const QString sign = way == 0 ? QStringLiteral("−") : QStringLiteral("+");
            key.axis = axis;
            key.sign = way == 0 ? -1 : 1;
            const auto a = static_cast<std::size_t>(axis);
            key.button = make_button(
                QStringLiteral("jog_%1%2").arg(short_names[a], way == 0 ? "minus" : "plus"), {},
                short_names[a] + " " + sign, names[a] + ", " + (way == 0 ? tr("back") : tr("ahead")), [] {});
            key.button->setAccessibleName(names[a] + ", " + (way == 0 ? tr("back") : tr("ahead")));
            key.button->setMinimumHeight(style::kTargetPx);
            connect(key.button, &QPushButton::pressed, this, [this, &key] { pressed(key); });
            connect(key.button, &QPushButton::released, this, &JogPanel::stop);
            key.button->installEventFilter(this);
            grid->addWidget(key.button, axis % 3, 2 * (axis / 3) + way);
        }
    static_cast<QVBoxLayout&>(*layout()).addLayout(grid);
}

std::string JogPanel::robot() const {
    return robot_->currentText().toStdString();
}

const RobotState* JogPanel::state() const {
    for (const RobotState& r : desk_.station().robots)
        if (r.id == robot()) return &r;
    return nullptr;
}

bool JogPanel::allowed() const {
    const RobotState* r = state();
    return r && r->can_move && r->base_from_flange && desk_.attended(robot());
}

// Of the selected spot's sensor, else of the first that has a calibration on this robot.
Pose JogPanel::flange_from_sensor() const {
    const Project& project = desk_.project();
    if (const Spot* spot = find_spot(project, desk_.selection().spot()); spot && spot->robot_id == robot())
        if (const Calibration* c = calibration_of(project, *spot)) return c->flange_from_sensor;
    for (const SensorSetup& sensor : project.sensors)
        if (const Calibration* c = calibration_of(project, sensor.id); c && c->robot_id == robot())
            return c->flange_from_sensor;
    return Pose::Identity();
}

void JogPanel::refresh() {
    const bool connected = desk_.station().connected;
    QStringList ids;
    for (const RobotSetup& r : desk_.project().robots) ids << QString::fromStdString(r.id);
    QStringList shown;
    for (int i = 0; i < robot_->count(); ++i) shown << robot_->itemText(i);
    if (ids != shown) {
        const QSignalBlocker quiet(robot_);
        const QString before = robot_->currentText();
        robot_->clear();
        robot_->addItems(ids);
        robot_->setCurrentText(before);
    }
    const RobotSetup* setup = find_robot(desk_.project(), robot());
    consent_->setVisible(setup && !is_simulated_cell(setup->driver));
    const QSignalBlocker quiet(consent_);
    consent_->setChecked(desk_.attended(robot()));
    if (consent_->isChecked()) asked_->hide();
    const bool steps = way_->currentIndex() == 0;
    step_->setEnabled(steps);
    speed_->setEnabled(!steps);
    const bool may = allowed();
    if (!may) stop();
    for (const Key& key : keys_) key.button->setEnabled(may);
    const RobotState* r = state();
    if (!setup)
        place_->setText(tr("The project has no robot yet."));
    else if (!connected || !r)
        place_->setText(tr("Connect the devices first."));
    else if (!r->trouble.empty())
        place_->setText(
            shown_error(tr("The robot does not answer."), Error{ErrorKind::device, r->trouble, {}, {}}));
    else if (!r->can_move)
        place_->setText(tr("This robot is not moved from here: jog it at its own panel."));
    else if (r->base_from_flange) {
        const Eigen::Vector3d p = r->base_from_flange->translation();
        const KukaAbc abc = kuka_from_rotation(r->base_from_flange->linear());
        place_->setText(tr("Flange: X %1  Y %2  Z %3 mm, A %4  B %5  C %6 degrees")
                            .arg(number(p.x(), 2), number(p.y(), 2), number(p.z(), 2), number(abc.a_deg, 3),
                                 number(abc.b_deg, 3), number(abc.c_deg, 3)));
    } else {
        place_->setText(
            tr("The robot does not tell where it stands, and is not moved from here before it does: move it "
               "once at its own panel."));
    }
}

void JogPanel::ask_for(const std::string& robot_id) {
    if (const int at = robot_->findText(QString::fromStdString(robot_id)); at >= 0)
        robot_->setCurrentIndex(at);
    set_verdict(*asked_,
                tr("The robot moves when somebody stands beside it: say so with the tick, then press again."),
                Tone::attention);
    asked_->show();
    consent_->setFocus();
}

void JogPanel::pressed(const Key& key) {
    if (!allowed()) return;
    message_->hide();
    pressed_ = &key;
    if (way_->currentIndex() == 0) {
        const JogStep& s = kJogSteps[static_cast<std::size_t>(step_->currentIndex())];
        step(s.mm, s.deg);
        return;
    }
    advanced_ = std::chrono::steady_clock::now();
    timer_.start();
}

void JogPanel::stop() {
    timer_.stop();
    // A single step that was asked for is done; of a motion that lasted nothing is to follow.
    if (pressed_ && way_->currentIndex() == 1) desk_.worker().stop_jog();
    pressed_ = nullptr;
}

void JogPanel::advance() {
    if (!pressed_ || !allowed()) return stop();
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::min(kLongestGap_s, std::chrono::duration<double>(now - advanced_).count());
    advanced_ = now;
    const double mm = speed_->value() * seconds;
    step(mm, kTurn_deg_per_mm * mm);
}

void JogPanel::step(double mm, double deg) {
    const RobotState* r = state();
    if (!r || !r->base_from_flange || !pressed_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - sent_ > kForgotten) target_.reset();
    sent_ = now;
    const Pose from = target_.value_or(*r->base_from_flange);
    Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
    if (pressed_->axis < 3)
        shift[pressed_->axis] = pressed_->sign * mm;
    else
        turn[pressed_->axis - 3] = pressed_->sign * rad_from_deg(deg);
    target_ =
        jogged(from, flange_from_sensor(), static_cast<JogFrame>(frame_->currentData().toInt()), shift, turn);
    desk_.worker().jog(robot(), *target_);
}

void JogPanel::moved(const std::string& robot_id, const Pose& base_from_flange, const QString& trouble) {
    if (robot_id != robot()) return;
    if (!trouble.isEmpty()) {
        stop();
        message_->setText(trouble);
        message_->show();
    }
    // Short of it, a newer place is on its way: the next step goes on from there.
    if (!trouble.isEmpty() || (target_ && distance_mm(*target_, base_from_flange) < kArrived_mm &&
                               angle_rad(*target_, base_from_flange) < kArrived_rad))
        target_.reset();
    desk_.note_pose(robot_id, base_from_flange);
}

void JogPanel::hideEvent(QHideEvent* event) {
    stop();
    target_.reset();
    QWidget::hideEvent(event);
}

void JogPanel::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape)
        stop();
    else
        QWidget::keyPressEvent(event);
}

bool JogPanel::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::FocusOut) stop();
    return QWidget::eventFilter(watched, event);
}

bool JogPanel::event(QEvent* event) {
    if (event->type() == QEvent::WindowDeactivate) stop();
    return QWidget::event(event);
}

}  // namespace seamwright
