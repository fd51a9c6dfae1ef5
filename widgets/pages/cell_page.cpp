#include "widgets/pages/cell_page.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QPointer>

#include "devices/exchange/json_fields.h"
#include "devices/registry.h"
#include "devices/simulated/scene/random.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "widgets/editors/leave_field.h"
#include "widgets/editors/list_habits.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/menu_signs.h"
#include "widgets/pages/parts/rename_dialog.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {
constexpr int kSensorRole = Qt::UserRole;
constexpr const char* kCameraDriver = "genicam";
constexpr int kName_px = 130;  // of a long name, beside which what the device does has its room
}  // namespace

CellPage::CellPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::cell,
               tr("Which sensors and robots there are, and which part they look at. Connect them here.")) {
    connect_ = make_button("connect", "plug", tr("Connect"), tr("Open all sensors and robots of the project"),
                           [this] { connect_devices(); });
    disconnect_ =
        make_button("disconnect", "unplug", tr("Disconnect"), tr("Let go of all sensors and robots"),
                    [this] { desk_.worker().disconnect_devices(); });
    box().addLayout(make_row({connect_, disconnect_}));
    box().addWidget(make_progress());

    box().addWidget(make_heading(tr("Sensors and robots")));
    devices_ = make_table("devices", {tr("Name"), tr("Kind"), tr("Driver"), tr("State")},
                          tr("Sensors and robots of the project"));
    devices_->setMinimumHeight(150);
    elide_first_column(*devices_, kName_px);
    connect(devices_, &QTableWidget::currentCellChanged, this, [this] {
        leave_field(*form_);
        if (is_pending()) {
            if (const QString why = refusal(); !why.isEmpty())
                emit desk_.trouble(not_taken(QString::fromStdString(shown_->id), why));
            else
                done(apply());
        }
        if (sensor_chosen()) desk_.selection().select_sensor(chosen());
        show_device();
    });
    box().addWidget(devices_);
    rename_ = make_button("rename_device", "rename", tr("Rename"), tr("Give the device another name"),
                          [this] { rename_device(); });
    remove_ = make_button("remove_device", "remove", tr("Remove"), tr("Take the device out of the project"),
                          [this] { remove_device(); });
    box().addLayout(make_row({make_button("add_sensor", "sensor", tr("Add sensor"), tr("A further sensor"),
                                          [this] { add_device(true); }),
                              make_button("add_robot", "robot", tr("Add robot"), tr("A further robot"),
                                          [this] { add_device(false); })}));
    search_ =
        make_button("search_cameras", "search", tr("Search cameras"),
                    tr("Asks all networks of this computer for cameras; one of them is taken by a click"),
                    [this] { desk_.worker().search_cameras(); });
    connect(&desk_.worker(), &StationWorker::cameras_found, this, [this](const auto& found) {
        if (isVisible()) offer_cameras(*found);
    });
    box().addLayout(make_row({search_, rename_, remove_}));
    add_list_deed(*devices_, *rename_, Qt::Key_F2);
    add_list_deed(*devices_, *remove_, QKeySequence::Delete);
    answers_ = make_text({});
    box().addWidget(answers_);

    driver_ = new QComboBox;
    driver_->setObjectName("driver");
    add_field(box(), tr("Driver"), driver_, tr("How the device is spoken to"));
    mode_row_ = new QWidget;
    auto* mode_box = new QVBoxLayout(mode_row_);
    mode_box->setContentsMargins(0, 0, 0, 0);
    mode_ = new QComboBox;
    mode_->setObjectName("required_mode");
    for (const RobotMode m : kModes)
        mode_->addItem(m == RobotMode::unknown ? tr("any but stopped and fault") : shown_word(to_string(m)));
    add_field(*mode_box, tr("Push only in mode"), mode_,
              tr("Pushes are refused while the robot is in another mode"));
    box().addWidget(mode_row_);
    form_ = new SettingsEditor;
    form_->setObjectName("settings_form");
    box().addWidget(form_);
    as_text_ =
        make_button("settings_as_text", "log", tr("Settings as text"),
                    tr("The settings as the project file holds them (JSON), to copy and to paste"), [] {});
    as_text_->setCheckable(true);
    settings_ = new QPlainTextEdit;
    settings_->setObjectName("settings");
    settings_->setAccessibleName(tr("Settings (JSON)"));
    settings_->setTabChangesFocus(true);
    settings_->setMinimumHeight(110);
    settings_->hide();
    connect(as_text_, &QPushButton::toggled, settings_, &QWidget::setVisible);
    box().addLayout(make_row({as_text_}));
    box().addWidget(settings_);
    settings_state_ = make_text({});
    settings_state_->setObjectName("settings_state");
    box().addWidget(settings_state_);
    connect(&desk_, &Desk::opened, this,
            [this] { shown_.reset(); });  // what waited belongs to the one before
    connect(driver_, &QComboBox::currentIndexChanged, this, [this] { show_table(); });
    connect(form_, &SettingsEditor::edited, this, [this] {
        const QSignalBlocker quiet(settings_);
        settings_->setPlainText(QString::fromStdString(form_->value().dump(2)));
        judge_settings();
    });
    connect(settings_, &QPlainTextEdit::textChanged, this, [this] {
        if (const auto json = parse_json(settings_->toPlainText().toStdString(), {});
            json && json->is_object())
            form_->set_value(*json);
        judge_settings();
    });
    apply_ =
        make_button("apply_device", "check", tr("Apply"),
                    tr("Take driver and settings over; connect again afterwards"), [this] { done(apply()); });
    box().addLayout(make_row({apply_}));
    parameters_ = new QWidget;
    parameters_box_ = new QVBoxLayout(parameters_);
    parameters_box_->setContentsMargins(0, 0, 0, 0);
    box().addWidget(parameters_);
    stripe_ = new StripePanel(desk_);
    stripe_->setObjectName("stripe_panel");
    connect(stripe_, &StripePanel::refused, this,
            [this](const Error& error) { done(tl::unexpected(error)); });
    box().addWidget(stripe_);

    box().addWidget(make_heading(tr("Part")));
    part_ = make_text({});
    part_->setObjectName("part");
    box().addWidget(part_);
    unit_ = new QComboBox;
    unit_->setObjectName("mesh_unit");
    unit_->addItem(tr("millimetre (checked)"), QString());
    unit_->addItem(tr("millimetre"), QStringLiteral("mm"));
    unit_->addItem(tr("metre"), QStringLiteral("m"));
    add_field(box(), tr("Unit of the file"), unit_, tr("STL, PLY and OBJ do not say their unit"));
    box().addLayout(make_row({make_button("import_part", "part", tr("Import part..."),
                                          tr("Mesh of the part in the work object frame: STL, PLY or OBJ"),
                                          [this] { import_part(); })}));
    auto* frame_label = new QLabel(tr("Work object in the robot's base"));
    box().addWidget(frame_label);
    workobject_ = new PoseEditor;
    workobject_->setObjectName("workobject");
    workobject_->setToolTip(tr("base_from_workobject: where the part as taught stands"));
    workobject_->setAccessibleName(tr("Work object in the robot's base"));
    box().addWidget(workobject_);
    connect(workobject_, &PoseEditor::committed, this, [this] {
        PartSetup part = desk_.project().part;
        part.base_from_workobject = workobject_->pose();
        done(desk_.edit_part(part, tr("Change the work object's frame")));
    });

    box().addWidget(make_heading(tr("Requirements")));
    box().addWidget(make_text(tr("What has to be reached before the cell is handed over.")));
    const QStringList names{tr("3 sigma, at most"), tr("Age of calibrations"), tr("Zero-shift runs"),
                            tr("Known translation"), tr("Known rotation")};
    for (const Field<Requirements>& f : requirement_fields()) {
        auto* editor = new ParameterEditor(f.info);
        connect(editor, &ParameterEditor::committed, this,
                [this, name = f.info.name](double value) { done(desk_.set_requirement(name, value)); });
        editor->set_name(names.value(static_cast<qsizetype>(requirements_.size())));
        box().addWidget(editor);
        requirements_.push_back(editor);
    }

    simulated_ = new QWidget;
    auto* sim = new QVBoxLayout(simulated_);
    sim->setContentsMargins(0, 0, 0, 0);
    sim->addWidget(make_heading(tr("Simulated part")));
    sim->addWidget(make_text(
        tr("Puts the next part into the simulated fixture: up to 10 mm and 0.6 degrees off, a little "
           "bent. Or the taught one again.")));
    place_ = make_button("place_part", "shift", tr("Displace"), tr("The next simulated part, displaced"),
                         [this] { place_part(); });
    auto* home = make_button("home_part", "home", tr("As taught"),
                             tr("The simulated part where it was taught"), [this] {
                                 if (!take_or_tell()) return;
                                 if (done(desk_.place_simulated_part(Pose::Identity(), 0, 0)))
                                     desk_.worker().connect_devices();
                             });
    sim->addLayout(make_row({place_, home}));
    box().addWidget(simulated_);
    box().addStretch(1);
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) refresh();
    });
}

bool CellPage::sensor_chosen() const {
    const auto* item = devices_->currentRow() < 0 ? nullptr : devices_->item(devices_->currentRow(), 0);
    return item && item->data(kSensorRole).toBool();
}

std::string CellPage::chosen() const {
    const auto* item = devices_->currentRow() < 0 ? nullptr : devices_->item(devices_->currentRow(), 0);
    return item ? item->text().toStdString() : std::string();
}

QWidget* CellPage::due() {
    const Project& p = desk_.project();
    if (p.sensors.empty()) return findChild<QWidget*>("add_sensor");
    if (p.robots.empty()) return findChild<QWidget*>("add_robot");
    return desk_.station().connected ? static_cast<QWidget*>(devices_) : connect_;
}

void CellPage::refresh() {
    const Project& p = desk_.project();
    for (std::size_t i = 0; i < requirements_.size(); ++i)
        requirements_[i]->refresh(requirement_fields()[i].get(p.requirements), subject());
    const StationState& s = desk_.station();
    QVector<QStringList> rows;
    for (const SensorSetup& sensor : p.sensors) {
        QString state = tr("not connected");
        for (const SensorState& k : s.sensors)
            if (k.id == sensor.id)
                state = k.trouble.empty() ? tr("ok, %1 frames").arg(k.counters.completed)
                                          : tr("no frame: %1").arg(shown(k.trouble));
        rows << QStringList{QString::fromStdString(sensor.id), tr("sensor"),
                            QString::fromStdString(sensor.driver), state};
    }
    for (const RobotSetup& robot : p.robots) {
        QString state = tr("not connected");
        for (const RobotState& k : s.robots)
            if (k.id == robot.id)
                state = k.trouble.empty() ? tr("ok, %1").arg(shown_word(to_string(k.mode)))
                                          : tr("silent: %1").arg(shown(k.trouble));
        rows << QStringList{QString::fromStdString(robot.id), tr("robot"),
                            QString::fromStdString(robot.driver), state};
    }
    set_rows(*devices_, rows);
    for (int r = 0; r < devices_->rowCount(); ++r)
        devices_->item(r, 0)->setData(kSensorRole, r < static_cast<int>(p.sensors.size()));
    if (devices_->currentRow() < 0 && devices_->rowCount() > 0) devices_->setCurrentCell(0, 0);
    show_device();
    connect_->setEnabled(desk_.is_open() && !p.sensors.empty());
    disconnect_->setEnabled(s.connected);
    part_->setText(
        p.part.mesh_ply.empty()
            ? tr("No mesh. Everything works without one; the 3D view is empty then.")
            : tr("%1, from %2")
                  .arg(QString::fromStdString(p.part.name), QString::fromStdString(p.part.mesh_source)));
    workobject_->refresh(p.part.base_from_workobject, subject());
    simulated_->setVisible(std::any_of(p.sensors.begin(), p.sensors.end(),
                                       [](const SensorSetup& x) { return is_simulated_cell(x.driver); }));
}

// The connected sensor's own settings; made anew when another sensor is shown.
void CellPage::show_parameters() {
    const SensorState* state = nullptr;
    for (const SensorState& s : desk_.station().sensors)
        if (sensor_chosen() && s.id == chosen()) state = &s;
    std::string key = state ? state->id : "";
    if (state)
        for (const ParameterInfo& info : state->parameters) key += "/" + info.name;
    if (key == shown_parameters_) return;
    shown_parameters_ = key;
    while (QLayoutItem* item = parameters_box_->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    if (!state || state->parameters.empty()) return;
    parameters_box_->addWidget(
        make_heading(tr("Exposure and trigger of sensor %1").arg(QString::fromStdString(state->id))));
    QWidget* before = apply_;
    for (const ParameterInfo& info : state->parameters) {
        auto* editor = new ParameterEditor(info);
        if (const auto it = state->values.find(info.name); it != state->values.end())
            editor->set_value(it->second);
        connect(editor, &ParameterEditor::committed, this,
                [this, id = state->id, name = info.name](double value) {
                    desk_.worker().set_sensor_parameter(id, name, value);
                });
        parameters_box_->addWidget(editor);
        setTabOrder(before, editor);
        before = editor;
    }
}

std::string CellPage::free_sensor_id() const {
    for (char letter = 'A'; letter <= 'Z'; ++letter)
        if (!find_sensor(desk_.project(), std::string(1, letter))) return std::string(1, letter);
    return desk_.free_id<SensorSetup>("A");
}

void CellPage::add_device(bool sensor) {
    std::string id;
    bool ok = false;
    if (sensor) {
        SensorSetup s;
        s.id = id = free_sensor_id();
        s.driver = "simulated";
        ok = done(desk_.add(s));
    } else {
        RobotSetup r;
        r.id = id = desk_.free_id<RobotSetup>("R");
        r.driver = "simulated";
        // Sensor and robot of one simulated cell have the same settings.
        for (const SensorSetup& s : desk_.project().sensors)
            if (is_simulated_cell(s.driver)) r.settings = s.settings;
        ok = done(desk_.add(r));
    }
    if (!ok) return;
    refresh();
    for (int row = 0; row < devices_->rowCount(); ++row)
        if (devices_->item(row, 0)->text().toStdString() == id &&
            devices_->item(row, 0)->data(kSensorRole).toBool() == sensor)
            devices_->setCurrentCell(row, 0);
    driver_->setFocus();
}

void CellPage::offer_cameras(const std::vector<DiscoveredCamera>& found) {
    auto* menu = new QMenu(this);
    menu->setObjectName("cameras");
    menu->setAttribute(Qt::WA_DeleteOnClose);
    for (const DiscoveredCamera& c : found)
        menu->addAction(
            with_signs(tr("%1 %2, serial %3, at %4")
                           .arg(QString::fromStdString(c.vendor), QString::fromStdString(c.model),
                                QString::fromStdString(c.serial), QString::fromStdString(c.address))),
            this, [this, c] { take_camera(c); });
    if (found.empty())
        menu->addAction(tr("No camera has answered: check power, cable and the network's address"))
            ->setEnabled(false);
    menu->popup(search_->mapToGlobal(QPoint(0, search_->height())));
}

// For the chosen sensor, where it is a camera without an address; else as a new sensor.
void CellPage::take_camera(const DiscoveredCamera& camera) {
    const SensorSetup* chosen_sensor = sensor_chosen() ? find_sensor(desk_.project(), chosen()) : nullptr;
    const bool free = chosen_sensor && chosen_sensor->driver == kCameraDriver &&
                      !chosen_sensor->settings.contains("address") &&
                      !chosen_sensor->settings.contains("serial");
    SensorSetup sensor;
    if (free) {
        sensor = *chosen_sensor;
    } else {
        sensor.id = free_sensor_id();
        sensor.driver = kCameraDriver;
    }
    // A camera on a bus has no address; its serial names it.
    const bool network = !camera.address.empty() && camera.protocol != "USB3Vision";
    sensor.settings[network ? "address" : "serial"] = network ? camera.address : camera.serial;
    done(free ? desk_.edit(sensor, tr("camera")) : desk_.add(sensor));
}

void CellPage::remove_device() {
    if (chosen().empty()) return;
    if (sensor_chosen())
        done(desk_.remove<SensorSetup>(chosen()));
    else
        done(desk_.remove<RobotSetup>(chosen()));
}

void CellPage::rename_device() {
    if (chosen().empty() || !take_or_tell()) return;
    ask_name(this, tr("Rename"), chosen(),
             [this, from = chosen(), sensor = sensor_chosen()](const std::string& to) {
                 return sensor ? desk_.rename<SensorSetup>(from, to) : desk_.rename<RobotSetup>(from, to);
             });
}

void CellPage::import_part() {
    const QString file =
        QFileDialog::getOpenFileName(this, tr("Import part"), {}, tr("Meshes (*.stl *.ply *.obj)"));
    if (file.isEmpty()) return;
    part_->setText(tr("Reading %1 ...").arg(QFileInfo(file).fileName()));
    desk_.import_part(file.toStdString(), unit_->currentData().toString().toStdString(),
                      [page = QPointer(this)](const Expected<void>& imported) {
                          if (!page) return;
                          page->done(imported);
                          page->refresh();
                      });
}

void CellPage::place_part() {
    if (!take_or_tell()) return;
    Random random(0x5ea3, ++placed_ + static_cast<std::uint64_t>(desk_.undo_stack().index()));
    Eigen::Vector3d t, w;
    for (int i = 0; i < 3; ++i) t[i] = random.uniform(-10, 10) / std::sqrt(3.0);
    for (int i = 0; i < 3; ++i) w[i] = rad_from_deg(random.uniform(-0.6, 0.6)) / std::sqrt(3.0);
    if (done(desk_.place_simulated_part(make_pose(rotation_exp(w), t), random.uniform(-0.3, 0.3),
                                        random.uniform(-0.2, 0.2))))
        desk_.worker().connect_devices();
}

}  // namespace seamwright
