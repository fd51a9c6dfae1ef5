#include "widgets/pages/calibrate_page.h"

#include <QDateTime>
#include <QFrame>

#include <algorithm>

#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "projects/reuse/simulated_truth.h"
#include "widgets/calibrate/verdict_word.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

QString age_of(const std::string& utc) {
    const QDateTime at = QDateTime::fromString(QString::fromStdString(utc), Qt::ISODateWithMs);
    if (!at.isValid()) return CalibratePage::tr("of unknown age");
    const auto days = at.daysTo(QDateTime::currentDateTimeUtc());
    return days == 0 ? CalibratePage::tr("of today")
                     : CalibratePage::tr("%n day(s) old", "", static_cast<int>(days));
}

bool measures_through_camera(CaptureKind kind) {
    switch (kind) {
        case CaptureKind::sphere_profile:
        case CaptureKind::stripe_line:
        case CaptureKind::board_pose:
        case CaptureKind::apex:
        case CaptureKind::board_points:
        case CaptureKind::board_chain:
        case CaptureKind::board_sights:
            return true;
        case CaptureKind::board_and_stripe:
        case CaptureKind::board_view:
        case CaptureKind::touch:
        case CaptureKind::files:
            break;
    }
    return false;
}

}  // namespace

CalibratePage::CalibratePage(Desk& desk, const Views& views)
    : StepPage(
          desk, views, Step::calibrate,
          tr("From pixels to millimetres on the flange. Each sensor uses one calibration; the others stay "
             "selectable.")) {
    QVBoxLayout& head = make_head();
    overview_ = new QWidget;
    auto* all = new QVBoxLayout(overview_);
    all->setContentsMargins(0, 0, 0, 0);
    all->setSpacing(8);
    cards_ = new QVBoxLayout;
    all->addLayout(cards_);
    all->addWidget(make_heading(tr("A new calibration")));
    sensor_ = new QComboBox;
    sensor_->setObjectName("calibration_sensor");
    robot_ = new QComboBox;
    robot_->setObjectName("calibration_robot");
    add_field(*all, tr("Sensor"), sensor_, tr("The sensor to calibrate"));
    add_field(*all, tr("Robot"), robot_, tr("The robot that carries it, or shows it the target"));
    connect(sensor_, &QComboBox::currentIndexChanged, this, [this] { refresh(); });
    // The camera and its laser plane first: the others measure through them.
    std::vector<CalibrationMethod> methods = calibration_methods();
    std::stable_partition(methods.begin(), methods.end(), [](const CalibrationMethod& m) {
        return m.guided && m.capture == CaptureKind::board_and_stripe;
    });
    for (const CalibrationMethod& method : methods) {
        if (!method.guided) continue;
        all->addWidget(make_heading(shown(method.title)));
        all->addWidget(make_text(shown(method.why)));
        if (measures_through_camera(method.capture)) {
            auto* before = make_text(
                tr("A sensor that delivers images needs this first: %1.").arg(shown(methods.front().title)));
            before->setObjectName("before_" + QString::fromStdString(method.id));
            set_verdict(*before, before->text(), Tone::attention);
            before_.push_back(before);
            all->addWidget(before);
        }
        auto* button = make_button("begin_" + QString::fromStdString(method.id), "play", tr("Begin"),
                                   shown(method.title), [this, name = method.id] { begin(name); });
        begins_[method.id] = button;
        if (!first_begin_) first_begin_ = button;
        all->addLayout(make_row({button}));
    }
    simulated_ = new QWidget;
    auto* sim = new QVBoxLayout(simulated_);
    sim->setContentsMargins(0, 0, 0, 0);
    sim->addWidget(make_heading(tr("Simulated cell")));
    sim->addWidget(
        make_text(tr("A simulated sensor knows where it is mounted: enough for learning the other steps.")));
    sim->addLayout(make_row({make_button("simulated_truth", "check", tr("Take the simulation's own"),
                                         tr("Adds the simulated cell's calibration and uses it"),
                                         [this] { take_simulated(); })}));
    all->addWidget(simulated_);
    box().addWidget(overview_);
    guided_ = new GuidedPage(desk_);
    guided_->hide();
    box().addWidget(guided_);
    head.addWidget(guided_->head());
    connect(guided_, &GuidedPage::under_way, this, &CalibratePage::under_way);
    connect(guided_, &GuidedPage::connect_wanted, this, &CalibratePage::connect_wanted);
    connect(guided_, &GuidedPage::left, this, [this] {
        show_guided(false);
        if (isVisible()) refresh();
    });
    connect(guided_, &GuidedPage::proposed, this, [this](const std::optional<Pose>& base_from_flange) {
        if (!base_from_flange) return views_.scene->set_next_robot(std::nullopt);
        SceneRobot next;
        next.workobject_from_flange = desk_.project().part.base_from_workobject.inverse() * *base_from_flange;
        next.workobject_from_sensor =
            next.workobject_from_flange * guided_->calibration().mounting().value_or(Pose::Identity());
        views_.scene->set_next_robot(next);
    });
    box().addStretch(1);
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) refresh();
    });
}

void CalibratePage::begin(const std::string& method) {
    if (!guided_->begin(MethodId(method), SensorId(sensor_->currentText().toStdString()),
                        RobotId(robot_->currentText().toStdString())))
        return;
    show_guided(true);
}

// The head of a calibration stands in place of the step's own: both would leave too little of a small window.
void CalibratePage::show_guided(bool guided) {
    for (const char* own : {"page_title", "page_state"}) head()->findChild<QLabel*>(own)->setVisible(!guided);
    overview_->setVisible(!guided);
    guided_->setVisible(guided);
    entered();
}

// Beside a calibration the scene shows where the robot is to go; the frozen contour is another step's.
void CalibratePage::entered() {
    if (guided_->isVisible()) views_.raise(views_.scene);
}

// One a sensor that is connected and has none yet, with the robot of its cell.
void CalibratePage::take_simulated() {
    const Project p = desk_.project();
    for (const SensorSetup& s : p.sensors) {
        if (!is_simulated_cell(s.driver) || !s.calibration_id.empty()) continue;
        for (const RobotSetup& r : p.robots) {
            if (!is_simulated_cell(r.driver) || r.settings != s.settings) continue;
            auto truth = simulated_truth(s, r);
            if (!truth) {
                done(tl::unexpected(truth.error()));
                return;
            }
            if (index_of<Calibration>(p, truth->id) >= 0) truth->id += " " + s.id;
            done(desk_.take_calibrations({std::move(*truth)}, true));
            break;
        }
    }
}

QWidget* CalibratePage::due() {
    if (guided_->isVisible()) return head()->findChild<QWidget*>("calibration_lead");
    return simulated_->isVisible() ? findChild<QWidget*>("simulated_truth") : first_begin_;
}

void CalibratePage::refresh() {
    const Project& p = desk_.project();
    simulated_->setVisible(desk_.station().connected &&
                           std::any_of(p.sensors.begin(), p.sensors.end(), [](const SensorSetup& s) {
                               return is_simulated_cell(s.driver) && s.calibration_id.empty();
                           }));
    const auto fill = [](QComboBox& list, const auto& things) {
        QStringList names;
        for (const auto& thing : things) names << QString::fromStdString(thing.id);
        QStringList shown;
        for (int i = 0; i < list.count(); ++i) shown << list.itemText(i);
        if (names == shown) return;
        const QSignalBlocker quiet(&list);
        const QString kept = list.currentText();
        list.clear();
        list.addItems(names);
        if (names.contains(kept)) list.setCurrentText(kept);
    };
    fill(*sensor_, p.sensors);
    fill(*robot_, p.robots);
    std::vector<std::string> sensors;
    for (const SensorSetup& s : p.sensors) sensors.push_back(s.id);
    for (auto& [method, button] : begins_) {
        button->setEnabled(sensor_->count() > 0);
        button->setText(desk_.is_open() && CalibrationSession::exists(
                                               desk_.path(), MethodId(method),
                                               SensorId(sensor_->currentText().toStdString()), sensors)
                            ? tr("Go on")
                            : tr("Begin"));
    }
    const Calibration* in_use = calibration_of(p, sensor_->currentText().toStdString());
    for (QLabel* before : before_) before->setVisible(!in_use || !in_use->model);
    std::string key;
    for (const Calibration& c : p.calibrations)
        key += c.id + std::string(name_of(c.verdict)) + c.created_utc + "\n";
    for (const SensorSetup& s : p.sensors) key += s.id + s.calibration_id + s.identity.serial + "\n";
    if (key == shown_ && cards_->count() > 0) return;
    shown_ = key;
    while (QLayoutItem* item = cards_->takeAt(0)) {
        if (item->widget()) item->widget()->deleteLater();
        delete item;
    }
    if (p.calibrations.empty()) cards_->addWidget(make_text(tr("The project holds no calibration yet.")));
    for (const Calibration& c : p.calibrations) {
        auto* card = new QFrame;
        card->setObjectName("card");
        card->setFrameShape(QFrame::StyledPanel);
        auto* box = new QVBoxLayout(card);
        box->addWidget(
            make_heading(tr("%1: sensor %2 on robot %3")
                             .arg(QString::fromStdString(c.id), QString::fromStdString(c.sensor_id),
                                  QString::fromStdString(c.robot_id))));
        auto* verdict = make_text({});
        box->addWidget(verdict);
        set_verdict(*verdict, tr("%1, %2").arg(verdict_word(c.verdict), age_of(c.created_utc)),
                    tone_of(c.verdict));
        box->addWidget(
            make_text(tr("Method %1. From: %2").arg(shown(Text::chosen(c.method)), shown(c.source))));
        const Eigen::Vector3d t = c.flange_from_sensor.translation();
        box->addWidget(make_text(tr("flange_from_sensor  X %1  Y %2  Z %3 mm")
                                     .arg(number(t.x(), 2), number(t.y(), 2), number(t.z(), 2))));
        const SensorSetup* sensor = find_sensor(p, c.sensor_id);
        if (sensor && !sensor->identity.serial.empty() && !(sensor->identity == c.sensor_identity)) {
            auto* other = make_text({});
            box->addWidget(other);
            set_verdict(*other,
                        tr("Made with device %1; connected is %2: pushes are refused.")
                            .arg(QString::fromStdString(c.sensor_identity.serial),
                                 QString::fromStdString(sensor->identity.serial)),
                        Tone::alarm);
        }
        const bool used = sensor && sensor->calibration_id == c.id;
        if (const CalibrationMethod* method = find_method(c.method);
            !used && (c.nozzle || (method && method->use != AnswerUse::sensor))) {
            box->addWidget(make_text(tr("Kept as a record: nothing is measured with it.")));
            cards_->addWidget(card);
            continue;
        }
        auto* use =
            make_button("use_calibration", "check", used ? tr("In use") : tr("Use"),
                        tr("Measure with this calibration from now on"), [this, id = c.id, s = c.sensor_id] {
                            done(desk_.use_calibration(SensorId(s), CalibrationId(id)));
                        });
        use->setEnabled(sensor && !used);
        box->addLayout(make_row({use}));
        cards_->addWidget(card);
    }
}

}  // namespace seamwright
