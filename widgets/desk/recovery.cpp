#include "widgets/desk/recovery.h"

#include <fmt/format.h>

#include <QCoreApplication>

#include "core/system_text.h"
#include "projects/file/project_json.h"
#include "widgets/desk/commands.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

struct RecoveryText {
    Q_DECLARE_TR_FUNCTIONS(RecoveryText)
};

template <class T>
const T* with_id(const std::vector<T>& list, const std::string& id) {
    for (const T& item : list)
        if (item.id == id) return &item;
    return nullptr;
}

template <class T>
bool same(const T& a, const T& b) {
    return to_json_document(a) == to_json_document(b);
}

template <class T>
void list_differences(const std::vector<T>& before, const std::vector<T>& after, QStringList& lines) {
    for (const T& item : after) {
        const T* old = with_id(before, item.id);
        const QString id = QString::fromStdString(item.id);
        if (!old)
            lines << RecoveryText::tr("%1 %2 added").arg(thing_name<T>(), id);
        else if (!same(*old, item))
            lines << RecoveryText::tr("%1 %2 changed").arg(thing_name<T>(), id);
    }
    for (const T& item : before)
        if (!with_id(after, item.id))
            lines << RecoveryText::tr("%1 %2 removed").arg(thing_name<T>(), QString::fromStdString(item.id));
}

}  // namespace

std::filesystem::path recovery_path(const std::filesystem::path& project_file) {
    return project_file.string() + ".recovery";
}

QStringList differences(const Project& before, const Project& after) {
    QStringList lines;
    if (before.name != after.name) lines << RecoveryText::tr("project renamed");
    if (!same(before.requirements, after.requirements)) lines << RecoveryText::tr("requirements changed");
    if (!same(before.part, after.part) || before.part.mesh_ply != after.part.mesh_ply)
        lines << RecoveryText::tr("part changed");
    list_differences(before.sensors, after.sensors, lines);
    list_differences(before.robots, after.robots, lines);
    list_differences(before.calibrations, after.calibrations, lines);
    list_differences(before.spots, after.spots, lines);
    list_differences(before.regions, after.regions, lines);
    if (lines.isEmpty() && !same(before, after)) lines << RecoveryText::tr("order changed");
    return lines;
}

Expected<std::optional<Recovery>> find_recovery(const std::filesystem::path& project_file,
                                                const Project& saved) {
    const auto path = recovery_path(project_file);
    std::error_code none;
    if (!std::filesystem::exists(path, none)) return std::nullopt;
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    Recovery recovery{std::move(project), std::filesystem::last_write_time(path, none), {}};
    recovery.holds = differences(saved, recovery.project);
    if (recovery.holds.isEmpty()) return std::nullopt;
    return recovery;
}

Expected<std::filesystem::path> set_aside_recovery(const std::filesystem::path& project_file) {
    const auto path = recovery_path(project_file);
    const std::string name = path.string() + ".damaged";
    std::filesystem::path aside = name;
    std::error_code failed;
    for (int n = 2; std::filesystem::exists(std::filesystem::symlink_status(aside, failed)); ++n)
        aside = fmt::format("{}-{}", name, n);
    std::filesystem::rename(path, aside, failed);
    if (failed)
        return file_error(Text("the file cannot be renamed: {}", system_text(failed)), path.string(),
                          "move it away");
    std::error_code none;  // a journal belongs to its file
    std::filesystem::rename(path.string() + "-journal", aside.string() + "-journal", none);
    return aside;
}

void discard_recovery(const std::filesystem::path& project_file) {
    std::error_code none;
    std::filesystem::remove(recovery_path(project_file), none);
    std::filesystem::remove(recovery_path(project_file).string() + "-journal", none);
}

RecoveryWriter::RecoveryWriter(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& stop) { work(stop); }) {}

RecoveryWriter::~RecoveryWriter() {
    flush();
    thread_.request_stop();
    wake_.notify_all();
}

void RecoveryWriter::open(const std::filesystem::path& project_file) {
    flush();
    const std::lock_guard lock(mutex_);
    target_ = project_file;
}

void RecoveryWriter::write(const Project& project) {
    {
        const std::lock_guard lock(mutex_);
        pending_ = std::make_unique<Project>(project);
        clear_ = kept_ = false;
    }
    wake_.notify_all();
}

void RecoveryWriter::clear() {
    {
        const std::lock_guard lock(mutex_);
        pending_.reset();
        clear_ = true;
        kept_ = false;
    }
    wake_.notify_all();
}

void RecoveryWriter::flush() {
    std::unique_lock lock(mutex_);
    wake_.notify_all();
    wake_.wait(lock, [&] { return !pending_ && !clear_ && !busy_; });
}

bool RecoveryWriter::kept() const {
    const std::lock_guard lock(mutex_);
    return kept_;
}

void RecoveryWriter::close() {
    flush();
    const std::lock_guard lock(mutex_);
    target_.clear();
}

void RecoveryWriter::work(const std::stop_token& stop) {
    std::optional<ProjectFile> file;
    for (;;) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, stop, [&] { return pending_ || clear_; });
        if (!pending_ && !clear_) return;
        const std::unique_ptr<Project> project = std::move(pending_);
        clear_ = false;
        const auto target = target_;
        busy_ = true;
        lock.unlock();
        QString told;
        bool wrote = false;
        if (!project || target.empty()) {
            file.reset();
            if (!target.empty()) discard_recovery(target);
        } else {
            const auto path = recovery_path(target);
            // Taken away from outside, or of another project: begun anew.
            std::error_code none;
            if (file && (file->path() != path || !std::filesystem::exists(path, none))) file.reset();
            if (file) {
                if (auto saved = file->save(*project); !saved) file.reset();
            }
            if (!file) {
                auto made = ProjectFile::create(path, *project, true);
                if (!made && std::filesystem::exists(path, none)) {
                    // What stands there is no project any more; it must not end the keeping of edits.
                    if (auto opens = ProjectFile::open(path, FileAccess::read_only); !opens)
                        if (auto aside = set_aside_recovery(target)) {
                            told = RecoveryText::tr(
                                       "The file that keeps unsaved edits went bad (%1). It was set "
                                       "aside as %2 and begun anew.")
                                       .arg(shown(opens.error().what),
                                            QString::fromStdString(aside->filename().string()));
                            made = ProjectFile::create(path, *project, true);
                        }
                }
                if (made)
                    file.emplace(std::move(*made));
                else
                    told = RecoveryText::tr("Unsaved edits are not kept against a crash: %1")
                               .arg(shown_error(made.error()));
            }
            wrote = file.has_value();
        }
        lock.lock();
        busy_ = false;
        kept_ = wrote && !pending_ && !clear_;
        lock.unlock();
        wake_.notify_all();
        if (!told.isEmpty()) emit trouble(told);
        if (wrote) emit written();
    }
}

}  // namespace seamwright
