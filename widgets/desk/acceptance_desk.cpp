#include "widgets/desk/acceptance_desk.h"

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/quality/qdas.h"
#include "devices/quality/study_csv.h"
#include "projects/acceptance/pages/acceptance_workbook.h"
#include "projects/acceptance/study/kept_offsets.h"
#include "widgets/shown_text.h"

namespace seamwright {

AcceptanceDesk::AcceptanceDesk(Desk& desk, QObject* parent) : QObject(parent), desk_(desk) {
    const auto due = [this] { due_ = true; };
    connect(&desk_, &Desk::project_changed, this, due);
    connect(&desk_, &Desk::runs_changed, this, due);
    connect(&desk_.worker(), &StationWorker::proven, this, due);
    connect(&desk_, &Desk::opened, this, [this] {
        ++document_;
        judged_ = {};
        extras_ = {};
        due_ = true;
    });
    connect(&desk_.worker(), &StationWorker::robot_studied, this,
            [this](const auto& robot) { keep(*robot); });
    connect(&desk_.worker(), &StationWorker::trigger_studied, this,
            [this](const auto& trigger) { keep(*trigger); });
}

AcceptanceDesk::~AcceptanceDesk() = default;

std::string AcceptanceDesk::region() const {
    const auto& regions = desk_.project().regions;
    const std::string selected = desk_.selection().region();
    if (!selected.empty() || regions.empty()) return selected;
    return regions.front().id;
}

AcceptanceDesk::Judged AcceptanceDesk::judge(const std::filesystem::path& path, const Project& project,
                                             const std::string& region_id, const AcceptanceExtras& extras) {
    Judged judged;
    judged.region_id = region_id;
    auto file = ProjectFile::open(path, FileAccess::read_only);
    if (!file) {
        judged.trouble = file.error().text();
        return judged;
    }
    auto stored = stored_acceptance(*file, project, region_id, extras);
    if (!stored) {
        judged.trouble = stored.error().text();
        return judged;
    }
    auto agenda = acceptance_agenda(*file, project, *stored);
    if (!agenda)
        judged.trouble = agenda.error().text();
    else
        judged.agenda = std::move(*agenda);
    judged.stored = std::move(*stored);
    return judged;
}

void AcceptanceDesk::look() {
    if (judging_ || !desk_.is_open() || desk_.worker().busy()) return;
    if (!due_ && judged_.region_id == region()) return;
    due_ = false;
    judging_ = true;
    if (thread_.joinable()) thread_.join();
    thread_ = std::jthread([this, document = document_, path = desk_.path(), project = desk_.project(),
                            id = region(), extras = extras_] {
        auto found = std::make_shared<Judged>(judge(path, project, id, extras));
        QMetaObject::invokeMethod(
            this,
            [this, document, found] {
                judging_ = false;
                if (document == document_) judged_ = std::move(*found);
                emit judged();
                look();  // what has changed meanwhile
            },
            Qt::QueuedConnection);
    });
}

Expected<void> AcceptanceDesk::import_references(const std::filesystem::path& csv) {
    SEAM_TRY(auto table, read_study_csv(csv));
    extras_.references = std::move(table);
    due_ = true;
    look();
    return {};
}

Expected<void> AcceptanceDesk::import_sensor_data(const std::filesystem::path& json) {
    SEAM_TRY(auto data, read_json_file(json));
    // What is wrong with it is said at once, and nothing of it is kept.
    SEAM_OK(sensor_check(data, json.string(), &desk_.project()));
    extras_.sensor_data = std::move(data);
    extras_.sensor_data_from = json.string();
    due_ = true;
    look();
    return {};
}

void AcceptanceDesk::keep(const MeasuredRobot& robot) {
    if (auto kept = desk_.record({0, {}, 0, robot.returns}); !kept)
        return emit desk_.trouble(shown_error(kept.error()));
    (void)desk_.edit_project([&](Project& p) { apply(robot, p); }, tr("Take the robot's repeatability"));
}

void AcceptanceDesk::keep(const MeasuredTrigger& trigger) {
    if (auto kept = desk_.record({0, {}, 0, trigger.passes}); !kept)
        return emit desk_.trouble(shown_error(kept.error()));
    (void)desk_.edit_project([&](Project& p) { apply(trigger, p); },
                             tr("Take the trigger's latency and jitter"));
}

Expected<void> AcceptanceDesk::edit_region(const std::function<Expected<void>(Region&)>& change,
                                           const QString& what) {
    const int at = index_of<Region>(desk_.project(), region());
    if (at < 0) return input_error("the project has no region");
    Region after = desk_.project().regions[static_cast<std::size_t>(at)];
    SEAM_OK(change(after));
    return desk_.edit(after, what);
}

Expected<int> AcceptanceDesk::keep_offset() {
    if (!stored() || !stored()->studies)
        return input_error("there is no correlation", {}, "import the other instrument's values");
    int version = 0;
    SEAM_OK(edit_region(
        [&](Region& r) -> Expected<void> {
            SEAM_TRY(auto kept, seamwright::keep_offset(r, *stored()->studies, utc_now()));
            version = kept;
            return {};
        },
        tr("the kept offsets")));
    return version;
}

Expected<void> AcceptanceDesk::switch_offset(int version) {
    auto done = edit_region([&](Region& r) { return seamwright::switch_offset(r, version); },
                            tr("the acting offset"));
    if (!done) return done;
    const int at = index_of<Region>(desk_.project(), region());
    const KeptOffset* acting = acting_offset(desk_.project().regions[static_cast<std::size_t>(at)]);
    desk_.note(
        EventKind::note, region(),
        acting ? said_of(ActingOffset{acting->version, acting->offset_mm}) : Text("no kept offset acts"));
    return {};
}

Expected<report::Page> AcceptanceDesk::page(Language language) const {
    if (!stored() || !stored()->anything())
        return input_error("there is nothing to report yet", {},
                           stored() && stored()->lacking ? stored()->lacking->text() : trouble());
    return acceptance_page(*stored(), desk_.path().filename().string(), language,
                           "Seamwright " SEAMWRIGHT_VERSION);
}

Expected<void> AcceptanceDesk::write_values(const std::filesystem::path& path, Language language) const {
    if (!stored() || !stored()->studies)
        return input_error("there are no values yet", {},
                           stored() && stored()->lacking ? stored()->lacking->text() : trouble());
    const Acceptance& acceptance = *stored()->studies;
    if (path.extension() == ".xlsx") return write_workbook(acceptance_workbook(acceptance, language), path);
    return write_text_file(path, dfq_text(qdas_study(acceptance)));
}

}  // namespace seamwright
