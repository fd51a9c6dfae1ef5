#include "widgets/pages/guided/guided_page.h"

#include <QClipboard>
#include <QFileDialog>
#include <QGuiApplication>
#include <QHeaderView>
#include <QImageReader>
#include <QPainter>
#include <QScrollArea>
#include <QShortcut>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "projects/measure/measure.h"
#include "widgets/editors/leave_field.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/into_view.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr QSize kThumbnail(64, 44);

}  // namespace

GuidedPage::GuidedPage(Desk& desk) : desk_(desk), calibration_(desk), series_(desk, calibration_) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    box->setSpacing(8);
    make_head();
    make_prepare(*box);
    make_capture(*box);
    make_list(*box);
    make_verdict(*box);
    make_use(*box);
    box->addStretch(1);
    connect(&calibration_, &CalibrationDesk::changed, this, &GuidedPage::refresh);
    connect(&calibration_, &CalibrationDesk::busy_changed, this, &GuidedPage::refresh_busy);
    connect(&series_, &CalibrationSeries::running_changed, this, &GuidedPage::refresh_busy);
    connect(&calibration_, &CalibrationDesk::looked, this, &GuidedPage::refresh_live);
    connect(&calibration_, &CalibrationDesk::still_changed, this, [this] {
        target_->set_ring(calibration_.stillness(), calibration_.automatic());
        automatic_->setChecked(calibration_.automatic());
    });
    connect(&calibration_, &CalibrationDesk::progressed, this, [this](int done, int total) {
        progress_->setRange(0, std::max(1, total));
        progress_->setValue(done);
    });
    connect(&calibration_, &CalibrationDesk::refused, this, [this](const QString& sentence) {
        say(first_in_doubt() ? sentence + "\n" +
                                   tr("Nothing is seen where the second pose should be: the first capture "
                                      "was probably not "
                                      "the target. Remove it, or correct the mounting from the drawing.")
                             : sentence);
    });
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (!desk_.station().connected) target_set_ = false;  // a cell begins with its part
        if (isVisible() && calibration_.is_open()) {
            refresh_stage();  // whether anything is connected
            refresh_live();
            refresh_base();  // which sensors are there
            refresh_next();
            refresh_busy();
        }
    });
    connect(&desk_, &Desk::project_changed, this, [this] {
        if (isVisible() && calibration_.is_open()) refresh();
    });
    connect(&desk_, &Desk::opened, this, [this] {
        propose(std::nullopt);
        emit left();
    });
}

bool GuidedPage::done(const Expected<void>& result) {
    if (result) return true;
    say(shown_error(result.error()));
    return false;
}

// Nobody solves or stores with the number before the one that stands in the field.
bool GuidedPage::take_typed() {
    said_->hide();
    QWidget* refused = refused_field(*this);
    if (!refused) return true;
    say(tr("A value is refused: mend it, or press Esc in its field."));
    bring_into_view(refused);
    refused->setFocus(Qt::OtherFocusReason);
    return false;
}

void GuidedPage::say(const QString& sentence) {
    set_verdict(*said_, sentence, Tone::attention);
    said_->show();
}

// The other poses follow from the first one: where nothing is seen at the second, it led there.
bool GuidedPage::first_in_doubt() const {
    if (!calibration_.is_open() || calibration_.session().state().captures.size() != 1) return false;
    constexpr double kThere_mm = 1;
    const auto at = flange();
    const auto next = next_pose(calibration_.session(), calibration_.mounting());
    return at && next && distance_mm(*at, next->base_from_flange) < kThere_mm;
}

bool GuidedPage::begin(const MethodId& method, const SensorId& sensor, const RobotId& robot) {
    said_->hide();
    pictures_.clear();
    shown_method_.clear();
    target_set_ = false;
    if (auto opened = calibration_.open(method, sensor, robot); !opened) {
        emit desk_.trouble(shown_error(opened.error()));
        return false;
    }
    needs_shown_ = calibration_.session().state().captures.empty();
    prepare_->setVisible(needs_shown_);
    refresh();
    calibration_.set_looking(true);
    return true;
}

void GuidedPage::leave() {
    series_.stop();
    if (target_set_) show_target(false);
    target_set_ = false;
    calibration_.set_looking(false);
    calibration_.close();
    propose(std::nullopt);
    emit left();
}

void GuidedPage::propose(const std::optional<Pose>& base_from_flange) {
    const bool same = proposed_.has_value() == base_from_flange.has_value() &&
                      (!proposed_ || proposed_->isApprox(*base_from_flange, 1e-12));
    proposed_ = base_from_flange;
    if (!same) emit proposed(proposed_);
}

void GuidedPage::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    head_->show();
    if (calibration_.is_open()) {
        if (target_set_) show_target(true);
        refresh();
        calibration_.set_looking(true);
    }
}

void GuidedPage::hideEvent(QHideEvent* event) {
    QWidget::hideEvent(event);
    head_->hide();
    series_.stop();
    // Whoever measures on another step measures the part.
    if (calibration_.is_open() && target_set_) show_target(false);
    calibration_.set_looking(false);
    calibration_.set_automatic(false);
    propose(std::nullopt);
    if (!std::exchange(under_way_, {}).isEmpty()) emit under_way(under_way_);
}

bool GuidedPage::simulated_sensor() const {
    const SensorSetup* s = find_sensor(desk_.project(), calibration_.session().sensor_id());
    return s && is_simulated_cell(s->driver);
}

std::optional<Pose> GuidedPage::flange() const {
    for (const RobotState& r : desk_.station().robots)
        if (r.id == calibration_.session().robot_id()) return r.base_from_flange;
    return std::nullopt;
}

void GuidedPage::set_target() {
    show_target(true);
    refresh_who();
    mark_next();
}

void GuidedPage::show_target(bool target) {
    const SensorSetup* sensor = find_sensor(desk_.project(), calibration_.session().sensor_id());
    const auto start =
        sensor ? simulated_start(calibration_.session().method(), sensor->settings) : std::nullopt;
    if (!start) return;
    const std::string scene(target ? std::string_view(start->scene) : to_string(Scene::part));
    for (const SensorState& s : desk_.station().sensors)
        if (s.id == sensor->id)
            for (const ParameterInfo& p : s.parameters)
                if (p.name == "scene") {
                    const auto at = std::find(p.choices.begin(), p.choices.end(), scene);
                    desk_.worker().set_sensor_parameter(sensor->id, "scene",
                                                        static_cast<double>(at - p.choices.begin()));
                    target_set_ = target_set_ || target;
                }
}

void GuidedPage::go_there() {
    const CalibrationSession& s = calibration_.session();
    if (const auto pose = next_place(s, desk_.project())) desk_.go_to(s.robot_id(), *pose);
}

void GuidedPage::load(bool folder) {
    const QString text = shown(calibration_.session().method().file);
    const QString chosen = folder ? QFileDialog::getExistingDirectory(this, text)
                                  : QFileDialog::getOpenFileName(this, text, {}, tr("Data (*.json)"));
    if (!chosen.isEmpty()) calibration_.load(chosen.toStdString());
}

std::string GuidedPage::selected() const {
    const QTableWidgetItem* item =
        table_->currentRow() >= 0 ? table_->item(table_->currentRow(), 0) : nullptr;
    return item ? item->data(Qt::UserRole).toString().toStdString() : std::string();
}

const EntryPicture& GuidedPage::picture(const SessionCapture& capture) {
    auto& kept = pictures_[capture.taken];
    if (kept.first.points.empty() && kept.second.isNull()) {
        kept.first = entry_picture(calibration_.session().method(), calibration_.session().state().settings,
                                   capture.taken->entry);
        QImage background;
        const auto file = calibration_.session().picture_of(*capture.taken);
        std::error_code code;
        if (!file.empty() && std::filesystem::exists(file, code) && kept.first.pixels) {
            QImageReader reader(QString::fromStdString(file.string()));
            QSize size = reader.size();
            size.scale(kThumbnail, Qt::KeepAspectRatio);
            reader.setScaledSize(size);
            background = reader.read();
        }
        QPixmap drawn(kThumbnail);
        drawn.fill(style::plot_ground(palette()));
        QPainter painter(&drawn);
        paint_entry(painter, QRectF(QPointF(), QSizeF(kThumbnail)), kept.first, background, palette());
        painter.end();
        kept.second = QIcon(drawn);
    }
    return kept.first;
}

QIcon GuidedPage::thumbnail(const SessionCapture& capture) {
    (void)picture(capture);
    return pictures_[capture.taken].second;
}

void GuidedPage::ticked(QTableWidgetItem* item) {
    if (item->column() != 0 || !calibration_.is_open()) return;
    const std::string id = item->data(Qt::UserRole).toString().toStdString();
    const bool used = item->checkState() == Qt::Checked;
    for (const SessionCapture& c : calibration_.session().state().captures)
        if (c.taken->id == id && c.left_out == used) {
            // The table is made anew by this: not while its item is being changed.
            QTimer::singleShot(0, this, [this, id, used] {
                if (calibration_.is_open()) done(calibration_.leave_out(id, !used));
            });
        }
}

}  // namespace seamwright
