// The form of one device: driver, settings and mode, until the project has them.

#include <QKeyEvent>

#include "devices/exchange/json_fields.h"
#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "widgets/editors/leave_field.h"
#include "widgets/into_view.h"
#include "widgets/pages/cell_page.h"
#include "widgets/shown_text.h"

namespace seamwright {

void CellPage::show_device() {
    const Project& p = desk_.project();
    const bool sensor = sensor_chosen();
    const std::string id = chosen();
    for (QWidget* w : std::initializer_list<QWidget*>{driver_, form_, settings_, rename_, remove_})
        w->setEnabled(!id.empty());
    mode_row_->setVisible(!id.empty() && !sensor);
    QString identity;
    const auto name = [&](const auto& setup, const std::string& model) {
        identity = setup.identity.serial.empty() ? tr("never connected")
                                                 : tr("answers as %1, serial %2")
                                                       .arg(QString::fromStdString(model),
                                                            QString::fromStdString(setup.identity.serial));
    };
    if (const SensorSetup* s = find_sensor(p, id); s && sensor)
        name(*s, s->identity.vendor + " " + s->identity.model);
    if (const RobotSetup* r = find_robot(p, id); r && !sensor)
        name(*r, r->identity.brand + " " + r->identity.model);
    if (const auto setup = stored(sensor, id)) show_setup(*setup);
    if (id.empty()) {
        shown_.reset();
        settings_->clear();
        show_table();
    }
    answers_->setText(identity);
    stripe_->refresh(sensor ? find_sensor(p, id) : nullptr);
    show_parameters();
}

// As the project has it. What was chosen or typed and is not taken over yet stays until the project has something else.
void CellPage::show_setup(const Setup& setup) {
    if (setup == shown_) return;
    shown_ = setup;
    {
        const QSignalBlocker quiet(driver_);
        driver_->clear();
        const auto list = [&](const auto& drivers) {
            for (const auto& d : drivers) {
                driver_->addItem(QString::fromStdString(std::string(d.name)));
                driver_->setItemData(driver_->count() - 1, shown(Text::chosen(d.help)), Qt::ToolTipRole);
            }
        };
        setup.sensor ? list(sensor_drivers()) : list(robot_drivers());
        driver_->setCurrentIndex(driver_->findText(QString::fromStdString(setup.driver)));
    }
    for (std::size_t i = 0; i < kModes.size(); ++i)
        if (kModes[i] == setup.mode) mode_->setCurrentIndex(static_cast<int>(i));
    const QString text = QString::fromStdString(setup.settings.dump(2));
    if (settings_->toPlainText() != text) settings_->setPlainText(text);
    show_table();
}

// The form of the chosen driver, filled with what the text says.
void CellPage::show_table() {
    static const SettingTable none;
    const SettingTable* table = &none;
    const std::string driver = driver_->currentText().toStdString();
    const auto look = [&](const auto& drivers) {
        for (const auto& d : drivers)
            if (d.name == driver) table = &d.settings();
    };
    if (!chosen().empty()) sensor_chosen() ? look(sensor_drivers()) : look(robot_drivers());
    if (table != shown_table_) {
        shown_table_ = table;
        form_->set_table(*table);
    }
    if (const auto json = parse_json(settings_->toPlainText().toStdString(), {}); json && json->is_object())
        form_->set_value(*json);
    judge_settings();
}

std::optional<CellPage::Setup> CellPage::stored(bool sensor, const std::string& id) const {
    if (const SensorSetup* s = sensor ? find_sensor(desk_.project(), id) : nullptr)
        return Setup{true, id, s->driver, s->settings, RobotMode::unknown};
    if (const RobotSetup* r = sensor ? nullptr : find_robot(desk_.project(), id))
        return Setup{false, id, r->driver, r->settings, r->required_mode};
    return std::nullopt;
}

bool CellPage::is_pending() const {
    if (!shown_ || stored(shown_->sensor, shown_->id) != shown_) return false;  // the project's counts
    const auto settings = parse_json(settings_->toPlainText().toStdString(), {});
    return !settings || form_->refused() || *settings != shown_->settings || driver() != shown_->driver ||
           (!shown_->sensor && mode() != shown_->mode);
}

// One that this program does not know stays.
std::string CellPage::driver() const {
    return driver_->currentIndex() < 0 && shown_ ? shown_->driver : driver_->currentText().toStdString();
}

RobotMode CellPage::mode() const {
    return kModes[static_cast<std::size_t>(std::max(0, mode_->currentIndex()))];
}

QString CellPage::take_typed() {
    leave_field(*form_);
    if (!is_pending()) return StepPage::take_typed();
    if (const QString why = refusal(); !why.isEmpty()) {
        show_refused();
        return not_taken(QString::fromStdString(shown_->id), why) + QChar(0x20) +
               tr("Mend them, or press Esc in the form: the old ones come back.");
    }
    if (const auto taken = apply(); !taken) {
        take_back();
        return shown_error(taken.error());
    }
    return StepPage::take_typed();
}

// Where it can be mended, or taken back by Esc.
void CellPage::show_refused() {
    if (form_->refused()) return form_->show_refused();
    (settings_->isVisible() ? static_cast<QWidget*>(settings_) : as_text_)->setFocus(Qt::OtherFocusReason);
    bring_into_view(settings_state_);
}

bool CellPage::take_or_tell() {
    const QString why = take_typed();
    if (!why.isEmpty()) emit desk_.trouble(why);
    return why.isEmpty();
}

void CellPage::connect_devices() {
    if (take_or_tell()) desk_.worker().connect_devices();
}

void CellPage::take_back() {
    shown_.reset();
    show_device();
}

void CellPage::keyPressEvent(QKeyEvent* event) {
    if (event->key() != Qt::Key_Escape || !is_pending()) return StepPage::keyPressEvent(event);
    take_back();
}

QString CellPage::refusal() const {
    if (!shown_) return {};
    const auto json = parse_json(settings_->toPlainText().toStdString(), {});
    if (!json) return tr("refused: this is no JSON");
    if (form_->refused()) return tr("refused: see the marked field");
    const auto sound = shown_table_ ? check_settings(*json, {}, *shown_table_) : Expected<void>();
    return sound ? QString() : tr("refused: %1").arg(shown_error(sound.error()));
}

void CellPage::judge_settings() {
    const QString why = refusal();
    set_verdict(*settings_state_, why, why.isEmpty() ? Tone::plain : Tone::alarm);
    settings_state_->setVisible(!why.isEmpty());
    apply_->setEnabled(why.isEmpty() && !chosen().empty());
}

// What the form held of a device that is not shown any more, or is not to be saved.
QString CellPage::not_taken(const QString& id, const QString& why) {
    return tr("%1: the settings are not taken over, %2.").arg(id, why);
}

Expected<void> CellPage::apply() {
    SEAM_TRY(const auto settings, parse_json(settings_->toPlainText().toStdString(), {}));
    if (!shown_ || !stored(shown_->sensor, shown_->id)) return {};
    if (shown_->sensor) {
        SensorSetup s = *find_sensor(desk_.project(), shown_->id);
        s.driver = driver();
        s.settings = settings;
        return desk_.edit(s, tr("settings"));
    }
    RobotSetup r = *find_robot(desk_.project(), shown_->id);
    r.driver = driver();
    r.settings = settings;
    r.required_mode = mode();
    return desk_.edit(r, tr("settings"));
}

}  // namespace seamwright
