#include "widgets/pages/parts/views.h"

#include <cmath>

#include "projects/measure/measure.h"
#include "widgets/shown_text.h"

namespace seamwright {

std::string shown_sensor(const Desk& desk, const Selection& selection) {
    if (const Spot* spot = find_spot(desk.project(), selection.spot())) return spot->sensor_id;
    if (find_sensor(desk.project(), selection.sensor())) return selection.sensor();
    return desk.project().sensors.empty() ? std::string() : desk.project().sensors.front().id;
}

Pose workobject_from_sensor(const Project& project, const Spot& spot) {
    const Calibration* calibration = calibration_of(project, spot);
    return project.part.base_from_workobject.inverse() * spot.base_from_flange *
           (calibration ? calibration->flange_from_sensor : Pose::Identity());
}

static constexpr int kCaption_ms = 250, kAge_ms = 200;

// Docks behind others in a tab group are visible to Qt; nothing of them is on the screen.
static bool seen(const QWidget* view) {
    return view->isVisible() && !view->visibleRegion().isEmpty();
}

ViewFeeder::ViewFeeder(Desk& desk, Views views, QObject* parent)
    : QObject(parent), desk_(desk), views_(std::move(views)) {
    connect(&desk_.live(), &LiveFeed::arrived, this, &ViewFeeder::live);
    connect(&desk_, &Desk::project_changed, this, [this] {
        project();
        selected();
    });
    connect(&desk_, &Desk::loading, views_.scene, &SceneView::expect_another);
    connect(&desk_, &Desk::opened, this, [this] {
        shifts_.clear();
        views_.align->clear();
        views_.residuals->set_data({});
        views_.trend->set_data({}, QStringLiteral("mm"), {}, {}, {});
        views_.histogram->set_data({}, QStringLiteral("mm"), std::vector<TrendSeries>(), {});
    });
    connect(&desk_, &Desk::station_changed, this, &ViewFeeder::robot);
    connect(&desk_.selection(), &Selection::changed, this, &ViewFeeder::selected);
    connect(views_.scene, &SceneView::spot_picked, this, [this](const QString& id) {
        if (!id.isEmpty()) desk_.selection().select_spot(id.toStdString());
    });
    connect(views_.residuals, &ResidualBars::spot_picked, this,
            [this](const QString& id) { desk_.selection().select_spot(id.toStdString()); });
    connect(views_.camera, &CameraView::region_dragged, this, &ViewFeeder::crop);
    connect(&age_timer_, &QTimer::timeout, this, &ViewFeeder::age);
    age_timer_.start(kAge_ms);
    project();
    selected();
    robot();
    desk_.live().taken();
}

void ViewFeeder::caption(const QString& text, bool stale) {
    if (text == caption_) return;
    caption_ = text;
    views_.profile->set_caption(text);
    views_.camera->set_caption(text);
    views_.profile->set_stale(stale);
    views_.camera->set_stale(stale);
}

// What is not renewed is not shown as if it were: a picture that grows old turns grey and says since when,
// one of a sensor that is not there any more goes.
void ViewFeeder::age() {
    const std::string sensor = shown_sensor(desk_, desk_.selection());
    const QString name = QString::fromStdString(sensor);
    const auto old = desk_.live().age(sensor);
    if (old && *old <= kStale) return;
    caption_age_.invalidate();  // the next picture's caption is due at once
    if (old) {
        caption(tr("sensor %1   no frame since %2 s").arg(name).arg(old->count() / 1000), true);
        views_.profile->set_feature(std::nullopt);
        return;
    }
    caption(sensor.empty()                  ? QString()
            : desk_.live().attached(sensor) ? tr("sensor %1   no frame yet").arg(name)
            // A proof that opens the devices for itself.
            : desk_.station().connected && desk_.worker().busy()
                ? tr("sensor %1   measures, no live picture").arg(name)
                : tr("sensor %1   not connected").arg(name),
            false);
    if (last_number_ == 0 && last_sensor_.empty()) return;
    last_number_ = 0;
    last_sensor_.clear();
    views_.profile->set_profile({});
    views_.profile->set_feature(std::nullopt);
    views_.camera->set_frame({}, nullptr);
    views_.align->set_live({});
}

void ViewFeeder::show_latest() {
    last_number_ = 0;
    live();
}

// The sensor sends only what was marked from now on; its settings in step Cell hold the numbers, to widen it
// again.
void ViewFeeder::crop(const QRect& region_px) {
    constexpr int kStep_px = 8;  // cameras take multiples
    const std::string id = shown_sensor(desk_, desk_.selection());
    views_.camera->set_region_tool(false);
    views_.camera->set_region({});
    for (const SensorState& s : desk_.station().sensors) {
        const auto x = s.values.find("region_x"), y = s.values.find("region_y");
        if (s.id != id || x == s.values.end() || y == s.values.end()) continue;
        const int left = region_px.left() / kStep_px * kStep_px, top = region_px.top() / kStep_px * kStep_px;
        const int width = (region_px.right() - left + kStep_px) / kStep_px * kStep_px;
        const int height = (region_px.bottom() - top + kStep_px) / kStep_px * kStep_px;
        StationWorker& worker = desk_.worker();
        worker.set_sensor_parameter(id, "region_width", width);  // smaller first: then it may move
        worker.set_sensor_parameter(id, "region_height", height);
        worker.set_sensor_parameter(id, "region_x", x->second + left);
        worker.set_sensor_parameter(id, "region_y", y->second + top);
        return;
    }
    emit desk_.trouble(
        tr("Sensor %1 cannot be told to send a part of its image.").arg(QString::fromStdString(id)));
}

void ViewFeeder::live() {
    desk_.live().taken();
    const std::string sensor = shown_sensor(desk_, desk_.selection());
    const auto snapshot = desk_.live().latest(sensor);
    if (!snapshot) return;
    if (sensor == last_sensor_ && snapshot->number == last_number_) return;
    last_sensor_ = sensor;
    last_number_ = snapshot->number;
    const auto dropped = snapshot->counters.damaged + snapshot->counters.underrun;
    QString text = tr("sensor %1   %2 /s   %3 dropped")
                       .arg(QString::fromStdString(sensor))
                       .arg(std::lround(snapshot->rate_hz))
                       .arg(dropped);
    if (!snapshot->trouble.empty()) text += "   " + shown(snapshot->trouble);
    // A rate that flickers by one is not worth laying the head of the plot out sixty times a second.
    const bool same_but_rate = sensor == captioned_sensor_ && dropped == captioned_dropped_ &&
                               snapshot->trouble == captioned_trouble_ && caption_age_.isValid();
    if (text != caption_ && !(same_but_rate && caption_age_.elapsed() < kCaption_ms)) {
        caption_age_.start();
        captioned_sensor_ = sensor;
        captioned_dropped_ = dropped;
        captioned_trouble_ = snapshot->trouble;
        caption(text, false);
    }
    if (seen(views_.profile)) {
        views_.profile->set_profile(snapshot->profile);
        views_.profile->set_feature(snapshot->feature);
    }
    if (seen(views_.camera) && snapshot->frame)
        views_.camera->set_frame(snapshot->frame->image, &snapshot->peaks);
    if (seen(views_.align)) views_.align->set_live(snapshot->profile);
}

void ViewFeeder::selected() {
    const Selection& s = desk_.selection();
    views_.scene->select_spot(s.spot());
    views_.scene->select_region(s.region());
    views_.residuals->select(QString::fromStdString(s.spot()));
    const Spot* spot = find_spot(desk_.project(), s.spot());
    if (spot && spot->reference_profile.size() > 0)
        views_.profile->set_reference(spot->reference_profile,
                                      Eigen::Vector2d(spot->reference_mm.x(), spot->reference_mm.z()));
    else
        views_.profile->clear_reference();
    if (spot && spot->feature.kind == "template" && spot->feature.template_profile.size() > 0)
        views_.profile->set_template(spot->feature.template_profile);
    else
        views_.profile->clear_template();
}

void ViewFeeder::project() {
    const Project& p = desk_.project();
    if (p.part.mesh_ply != shown_mesh_) {
        shown_mesh_ = p.part.mesh_ply;
        views_.scene->set_part_ply(shown_mesh_);
    }
    std::vector<SceneSpot> spots;
    for (const Spot& spot : p.spots) {
        SceneSpot s;
        s.id = spot.id;
        s.workobject_from_sensor = workobject_from_sensor(p, spot);
        s.reference_mm = spot.reference_mm;
        s.enabled = spot.enabled;
        if (const auto it = shifts_.find(spot.id); it != shifts_.end()) s.shift_mm = it->second;
        spots.push_back(std::move(s));
    }
    views_.scene->set_spots(spots);
    std::vector<SceneRegion> regions;
    for (const Region& region : p.regions) {
        SceneRegion r;
        r.id = region.id;
        r.spot_ids = region.spot_ids;
        if (auto plan = plan_region(planned_observations(p, region), correction_options(p, region))) {
            const Eigen::Vector3d along = plan->weakest_direction.head<3>();
            if (along.norm() > 0.1 && region.id == desk_.selection().region())
                r.weak_direction = along.normalized();
            r.weak_text = shown(plan->weakest).toStdString();
        }
        regions.push_back(std::move(r));
    }
    views_.scene->set_regions(regions);
}

void ViewFeeder::robot() {
    const std::string sensor = shown_sensor(desk_, desk_.selection());
    const Project& p = desk_.project();
    const SensorSetup* setup = find_sensor(p, sensor);
    const Calibration* calibration = nullptr;
    if (setup)
        for (const Calibration& c : p.calibrations)
            if (c.id == setup->calibration_id) calibration = &c;
    for (const RobotState& r : desk_.station().robots) {
        if (!r.base_from_flange || (calibration && calibration->robot_id != r.id)) continue;
        SceneRobot robot;
        robot.workobject_from_flange = p.part.base_from_workobject.inverse() * *r.base_from_flange;
        robot.workobject_from_sensor =
            robot.workobject_from_flange * (calibration ? calibration->flange_from_sensor : Pose::Identity());
        views_.scene->set_robot(robot);
        return;
    }
    views_.scene->set_robot(std::nullopt);
}

void ViewFeeder::show_run(const RunRecord* run) {
    shifts_.clear();
    if (run)
        for (const SpotMeasurement& m : run->spots) {
            const Spot* spot = find_spot(desk_.project(), m.spot_id);
            if (!spot || m.status != SpotStatus::measured) continue;
            shifts_[m.spot_id] = workobject_from_sensor(desk_.project(), *spot).linear() *
                                 (m.measured_mm - spot->reference_mm);
        }
    project();
}

}  // namespace seamwright
