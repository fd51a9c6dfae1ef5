#include "widgets/pages/calibrate_page.h"

#include <QClipboard>
#include <QDateTime>
#include <QFrame>
#include <QGuiApplication>

#include <algorithm>

#include "projects/measure.h"
#include "projects/simulated_truth.h"

namespace seamwright {
namespace {

QString age_of(const std::string& utc) {
    const QDateTime at = QDateTime::fromString(QString::fromStdString(utc), Qt::ISODateWithMs);
    if (!at.isValid()) return CalibratePage::tr("of unknown age");
    const auto days = at.daysTo(QDateTime::currentDateTimeUtc());
    return days == 0 ? CalibratePage::tr("of today") : CalibratePage::tr("%1 days old").arg(days);
}

}  // namespace

CalibratePage::CalibratePage(Desk& desk, const Views& views)
    : StepPage(
          desk, views, Step::calibrate,
          tr("From pixels to millimetres on the flange. Each sensor uses one calibration; the others stay "
             "selectable.")) {
    cards_ = new QVBoxLayout;
    box().addLayout(cards_);
    box().addWidget(make_heading(tr("A new calibration")));
    const auto method = [this](const QString& name, const QString& text, const QString& command) {
        box().addWidget(make_heading(name));
        box().addWidget(make_text(text));
        auto* line = make_text(command);
        line->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
        box().addWidget(line);
        box().addLayout(
            make_row({make_button("copy_command", "copy", tr("Copy the command"),
                                  tr("Puts the command line into the clipboard: %1").arg(command),
                                  [command] { QGuiApplication::clipboard()->setText(command); })}));
    };
    method(tr("Camera and laser plane"),
           tr("Images of a board with the stripe across it, in 8 or more orientations."),
           "seamwright calibrate stripe-camera DIR --board 7x6 --pitch-mm 10 --json camera.json");
    method(tr("Sensor on the flange"), tr("Cuts of one sphere from 9 or more orientations of the flange."),
           "seamwright calibrate tcp-sphere DATA.json --json tcp.json");
    simulated_ = new QWidget;
    auto* sim = new QVBoxLayout(simulated_);
    sim->setContentsMargins(0, 0, 0, 0);
    sim->addWidget(make_heading(tr("Simulated cell")));
    sim->addWidget(
        make_text(tr("A simulated sensor knows where it is mounted: enough for learning the other steps.")));
    sim->addLayout(make_row({make_button("simulated_truth", "check", tr("Take the simulation's own"),
                                         tr("Adds the simulated cell's calibration and uses it"),
                                         [this] { take_simulated(); })}));
    box().addWidget(simulated_);
    box().addStretch(1);
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) refresh();
    });
}

// One a sensor that is connected and has none yet, with the robot of its cell.
void CalibratePage::take_simulated() {
    const Project p = desk_.project();
    for (const SensorSetup& s : p.sensors) {
        if (s.driver != "simulated" || !s.calibration_id.empty()) continue;
        for (const RobotSetup& r : p.robots) {
            if (r.driver != "simulated" || r.settings != s.settings) continue;
            auto truth = simulated_truth(s, r);
            if (!truth) {
                done(tl::unexpected(truth.error()));
                return;
            }
            if (index_of<Calibration>(p, truth->id) >= 0) truth->id += " " + s.id;
            const std::string id = truth->id;
            if (done(desk_.add(std::move(*truth)))) done(desk_.use_calibration(s.id, id));
            break;
        }
    }
}

void CalibratePage::refresh() {
    const Project& p = desk_.project();
    simulated_->setVisible(desk_.station().connected &&
                           std::any_of(p.sensors.begin(), p.sensors.end(), [](const SensorSetup& s) {
                               return s.driver == "simulated" && s.calibration_id.empty();
                           }));
    std::string key;
    for (const Calibration& c : p.calibrations) key += c.id + c.verdict + c.created_utc + "\n";
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
        set_verdict(*verdict, tr("%1, %2").arg(QString::fromStdString(c.verdict), age_of(c.created_utc)),
                    c.verdict == "good"     ? Tone::good
                    : c.verdict == "usable" ? Tone::attention
                                            : Tone::alarm);
        box->addWidget(
            make_text(tr("Method %1. From: %2")
                          .arg(QString::fromStdString(c.method), QString::fromStdString(c.source))));
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
        auto* use = make_button("use_calibration", "check", used ? tr("In use") : tr("Use"),
                                tr("Measure with this calibration from now on"),
                                [this, id = c.id, s = c.sensor_id] { done(desk_.use_calibration(s, id)); });
        use->setEnabled(sensor && !used);
        box->addLayout(make_row({use}));
        cards_->addWidget(card);
    }
}

}  // namespace seamwright
