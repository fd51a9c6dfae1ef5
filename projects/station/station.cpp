#include "projects/station/station.h"

#include <algorithm>

#include "projects/station/run_release.h"
#include "projects/station/station_impl.h"

namespace seamwright {

void Station::Impl::disconnect() {
    for (auto& [id, sensor] : sensors) sensor->stop();
    sensors.clear();
    robots.clear();
    session = DeviceSession();
    use.reset();
    if (connected) file.keep_write_ahead(false);
    connected = false;
}

// Who answers, into the project. A robot that does not tell its name keeps the old one out of the way:
// none.
void Station::Impl::take_identities() {
    for (SensorSetup& setup : project.sensors)
        if (const auto it = sensors.find(setup.id); it != sensors.end())
            setup.identity = it->second->identity();
    for (RobotSetup& setup : project.robots)
        if (const auto it = robots.find(setup.id); it != robots.end()) {
            auto identity = it->second->identity();
            setup.identity = identity ? *identity : RobotIdentity{};
        }
}

std::map<std::string, RobotLink*> Station::Impl::links() const {
    std::map<std::string, RobotLink*> all;
    for (const auto& [id, robot] : robots) all[id] = robot.get();
    return all;
}

std::map<std::string, RobotLink*> Station::Impl::links(const std::vector<std::string>& ids) const {
    std::map<std::string, RobotLink*> some;
    for (const std::string& id : ids) some[id] = robots.at(id).get();
    return some;
}

Station::Station(ProjectFile file, Project project)
    : impl_(std::make_unique<Impl>(std::move(file), std::move(project))) {}
Station::Station(Station&&) noexcept = default;
Station& Station::operator=(Station&&) noexcept = default;
Station::~Station() {
    if (impl_) impl_->disconnect();
}

Expected<Station> Station::open(const std::filesystem::path& path, FileAccess access) {
    SEAM_TRY(auto file, ProjectFile::open(path, access));
    SEAM_TRY(auto project, file.load());
    Station station(std::move(file), std::move(project));
    station.impl_->writable = access == FileAccess::read_write;
    return station;
}

const Project& Station::project() const {
    return impl_->project;
}
ProjectFile& Station::file() {
    return impl_->file;
}
void Station::record_to(std::shared_ptr<Recorder> recorder) {
    impl_->recorder = std::move(recorder);
    impl_->recorded.clear();
}

bool Station::connected() const {
    return impl_->connected;
}
void Station::disconnect() {
    impl_->disconnect();
}

ProfileSource* Station::sensor(const std::string& id) {
    const auto it = impl_->sensors.find(id);
    return it == impl_->sensors.end() ? nullptr : it->second.get();
}

RobotLink* Station::robot(const std::string& id) {
    const auto it = impl_->robots.find(id);
    return it == impl_->robots.end() ? nullptr : it->second.get();
}

Expected<void> Station::edit(const Project& project) {
    SEAM_OK(impl_->file.save(project));
    impl_->project = project;
    return {};
}

namespace {

template <class Setup>
bool has(const std::vector<Setup>& setups, const std::string& id) {
    return std::ranges::any_of(setups, [&](const Setup& s) { return s.id == id; });
}

template <class Setup>
bool same_device(const Setup& a, const Setup& b) {
    return a.driver == b.driver && a.settings == b.settings;
}

// The links by the names that their devices have in `after`; those whose devices keep their names stay as they are. False: one's
// device is not in it any more, or its name is now another connected device's.
template <class Setup, class Link>
bool rename_links(std::map<std::string, std::unique_ptr<Link>>& links, const std::vector<Setup>& before,
                  const std::vector<Setup>& after) {
    std::map<std::string, std::unique_ptr<Link>> renamed;
    for (const Setup& setup : before) {
        if (!links.contains(setup.id)) continue;
        const auto same_name = std::ranges::find(after, setup.id, &Setup::id);
        if (same_name != after.end()) {
            const bool of_another = std::ranges::any_of(before, [&](const Setup& other) {
                return same_device(*same_name, other) && !same_device(setup, other);
            });
            if (of_another && !same_device(*same_name, setup)) return false;
            continue;
        }
        const auto now = std::ranges::find_if(after, [&](const Setup& s) {
            return same_device(s, setup) && !has(before, s.id) && !renamed.contains(s.id);
        });
        if (now == after.end()) return false;
        renamed[now->id] = std::move(links[setup.id]);
        links.erase(setup.id);
    }
    links.merge(renamed);
    return true;
}

template <class Setup, class Link>
bool has_all(const std::vector<Setup>& setups, const std::map<std::string, std::unique_ptr<Link>>& links) {
    return std::ranges::all_of(links, [&](const auto& link) { return has(setups, link.first); });
}

}  // namespace

void Station::use(const Project& project) {
    Impl& i = *impl_;
    const bool names = has_all(project.sensors, i.sensors) && has_all(project.robots, i.robots);
    if (i.connected &&
        ((i.recorder && !names) || !rename_links(i.sensors, i.project.sensors, project.sensors) ||
         !rename_links(i.robots, i.project.robots, project.robots)))
        i.disconnect();
    i.project = project;
}

Expected<std::vector<EditOfOthers>> measuring_edits(const ProjectFile& file) {
    SEAM_TRY(auto edits, file.edits_of_others());
    std::erase_if(edits, [](const EditOfOthers& edit) {
        return edit.table == "line" || edit.table == "drift_watch" || edit.table == "fixture" ||
               edit.table == "fleet";
    });
    return edits;
}

Expected<std::vector<EditOfOthers>> Station::follow_file() {
    Impl& i = *impl_;
    SEAM_TRY(auto edits, measuring_edits(i.file));
    if (edits.empty()) return edits;
    SEAM_TRY(auto project, i.file.load_anew());
    const auto same = [](const auto& before, const auto& after) {
        return std::ranges::equal(before, after, [](const auto& a, const auto& b) {
            return a.id == b.id && a.driver == b.driver && a.settings == b.settings;
        });
    };
    if (!same(i.project.sensors, project.sensors) || !same(i.project.robots, project.robots)) i.disconnect();
    i.project = std::move(project);
    if (i.connected) i.take_identities();
    return edits;
}

Expected<void> Station::connect(const Patience& patience) {
    Impl& i = *impl_;
    i.disconnect();
    const auto alone = [](const auto& setups) {
        return std::any_of(setups.begin(), setups.end(),
                           [](const auto& setup) { return !is_own_device(setup.driver); });
    };
    if (alone(i.project.sensors) || alone(i.project.robots)) {
        SEAM_TRY(auto use, FileUse::take(i.file.path(), FileUse::For::devices));
        i.use = std::move(use);
    }
    const auto give_up = [&](Error error, const Text& where) {
        i.disconnect();
        error.within(where);
        return tl::unexpected(std::move(error));
    };
    for (const SensorSetup& setup : i.project.sensors) {
        auto sensor = open_sensor(setup.driver, setup.settings, i.session, patience);
        if (!sensor) return give_up(sensor.error(), Text("sensor {}", setup.id));
        if (i.recorder) {
            auto source = i.recorded_as("sensor " + setup.id, [&] {
                return i.recorder->add_sensor(setup.id, (*sensor)->identity());
            });
            if (!source) return give_up(source.error(), Text("sensor {}", setup.id));
            *sensor = record_sensor(std::move(*sensor), i.recorder, *source);
        }
        i.sensors[setup.id] = std::move(*sensor);
    }
    for (const RobotSetup& setup : i.project.robots) {
        auto robot = open_robot(setup.driver, setup.settings, i.session);
        if (!robot) return give_up(robot.error(), Text("robot {}", setup.id));
        auto identity = (*robot)->identity();
        if (!identity) return give_up(identity.error(), Text("robot {}", setup.id));
        if (i.recorder) {
            auto source = i.recorded_as("robot " + setup.id,
                                        [&] { return i.recorder->add_robot(setup.id, *identity); });
            if (!source) return give_up(source.error(), Text("robot {}", setup.id));
            *robot = record_robot(std::move(*robot), i.recorder, *source);
        }
        i.robots[setup.id] = std::move(*robot);
    }
    i.connected = true;
    i.file.keep_write_ahead(true);
    i.take_identities();
    if (i.writable) resolve_release(i.file, i.links());
    return {};
}

void Station::connect(std::map<std::string, std::unique_ptr<ProfileSource>> sensors,
                      std::map<std::string, std::unique_ptr<RobotLink>> robots) {
    impl_->disconnect();
    impl_->sensors = std::move(sensors);
    impl_->robots = std::move(robots);
    impl_->connected = true;
    impl_->file.keep_write_ahead(true);
    impl_->take_identities();
    if (impl_->writable) resolve_release(impl_->file, impl_->links());
}

const DriftStanding& Station::drift() const {
    return impl_->standing;
}

}  // namespace seamwright
