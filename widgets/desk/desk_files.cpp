// The desk's document and the disk: made, opened, saved, kept against crashes.

#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "projects/calibrate/session/session.h"
#include "widgets/desk/desk.h"
#include "widgets/shown_text.h"

namespace seamwright {

std::filesystem::path Desk::path() const {
    return file_ ? file_->path() : std::filesystem::path();
}

void Desk::take_over(ProjectFile file, Project project) {
    file_.emplace(std::move(file));
    person_ = file_->person();
    if (!person_) signed_in_.reset();
    import_.drop();
    project_ = std::move(project);
    facts_ = {};
    undo_.clear();
    restored_ = false;
    state_ = std::make_shared<const StationState>();
    attended_.clear();
    recovery_writer_.open(file_->path());
    worker_.open(file_->path(), project_);
    worker_.act_for(signed_in_);
    selection_.select_spot(project_.spots.empty() ? "" : project_.spots.front().id);
    selection_.select_region(project_.regions.empty() ? "" : project_.regions.front().id);
    selection_.select_sensor(project_.sensors.empty() ? "" : project_.sensors.front().id);
    select_measured_type();
    was_modified_ = false;
    set_recipes();
    derive();
    emit opened();
    emit person_changed();
    emit modified_changed(false);
    emit project_changed();
    emit runs_changed();
    emit events_changed();
}

void Desk::drop_kept() {
    if (file_ && !recovery_) recovery_writer_.clear();
}

void Desk::keep_newest() {
    if (modified() && !recovery_) recovery_writer_.write(project_);
    recovery_writer_.flush();
}

Expected<void> Desk::create(const std::filesystem::path& path, const Project& project) {
    if (file_ && path == file_->path()) close();
    SEAM_TRY(auto use, FileUse::take(path, FileUse::For::desk));
    SEAM_TRY(auto file, ProjectFile::create(path, project, true));
    if (auto aside = CalibrationSession::put_aside(path); !aside) emit trouble(shown_error(aside.error()));
    discard_recovery(path);
    drop_kept();
    recovery_.reset();
    emit loading();
    take_over(std::move(file), project);
    use_ = std::move(use);
    return {};
}

Expected<void> Desk::open(const std::filesystem::path& path) {
    std::optional<FileUse> use;
    if (!file_ || path != file_->path()) {
        SEAM_TRY(auto taken, FileUse::take(path, FileUse::For::desk));
        use = std::move(taken);
    }
    SEAM_TRY(auto file, ProjectFile::open(path));
    SEAM_TRY(auto project, file.load());
    // Edits that were not saved in the project that is left are given up; before the look at what a crash
    // left, because both may be one file.
    drop_kept();
    recovery_writer_.flush();
    auto found = find_recovery(path, project);
    sign_out("signed out: the project was opened anew");
    recovery_.reset();
    QString told;
    if (found) {
        recovery_ = std::move(*found);
    } else if (const auto aside = set_aside_recovery(path)) {
        told = tr("The unsaved edits of an earlier session cannot be read (%1). They were set aside as %2.")
                   .arg(shown(found.error().what), QString::fromStdString(aside->filename().string()));
    } else {
        told = tr("The unsaved edits of an earlier session cannot be read (%1). They stand in the way of "
                  "those of "
                  "this session, which are not kept against a crash: %2")
                   .arg(shown(found.error().what), shown_error(aside.error()));
    }
    emit loading();
    take_over(std::move(file), std::move(project));
    if (use) use_ = std::move(*use);
    if (!told.isEmpty()) {
        note(EventKind::note, "studio", told.toStdString());
        emit trouble(told);
    }
    return {};
}

void Desk::restore() {
    if (!recovery_ || !file_) return;
    project_ = std::move(recovery_->project);
    recovery_.reset();
    restored_ = true;
    undo_.clear();
    note(EventKind::note, "studio", "unsaved edits of an earlier session restored");
    changed();
}

void Desk::forget_recovery() {
    recovery_.reset();
    if (!file_) return;
    if (modified())
        recovery_writer_.write(project_);
    else
        recovery_writer_.clear();
}

Expected<void> Desk::save() {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    // An older state left behind by a crash after the save would be offered as unsaved edits; one that equals
    // what was saved is not.
    keep_newest();
    SEAM_OK(file_->save(project_));
    restored_ = false;
    undo_.setClean();
    drop_kept();
    if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
    return {};
}

QString Desk::edited_elsewhere() const {
    if (!file_) return {};
    const auto edits = measuring_edits(*file_);
    if (!edits) return shown_error(edits.error());
    return edits->empty() ? QString() : shown(said_of(edits->front()));
}

Expected<void> Desk::save_as(const std::filesystem::path& path) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    if (path == file_->path()) return save();
    if (worker_.busy())
        return usage_error("a measurement is running", path.string(), "wait for its end or cancel it");
    SEAM_TRY(auto use, FileUse::take(path, FileUse::For::desk));
    keep_newest();
    // The old file keeps what was saved there; runs go along.
    const auto target = behind_links(path);
    const auto part = std::filesystem::path(target.string() + ".part");
    std::error_code failed;
    SEAM_OK(file_->copy_to(part));
    {
        SEAM_TRY(auto copy, ProjectFile::open(part));
        if (signed_in_) SEAM_OK(copy.act_for(*signed_in_));
        SEAM_OK(copy.save(project_));
    }
    discard_recovery(path);  // of a file that is replaced; must not meet the one that takes its name
    std::filesystem::rename(part, target, failed);
    if (failed)
        return file_error(Text("the file cannot be replaced: {}", system_text(failed)), path.string());
    drop_kept();
    recovery_writer_.flush();
    if (auto copied = CalibrationSession::copy_all(file_->path(), path); !copied)
        emit trouble(shown_error(copied.error()));
    SEAM_TRY(auto file, ProjectFile::open(path));
    if (signed_in_) SEAM_OK(file.act_for(*signed_in_));
    const std::string spot = selection_.spot(), region = selection_.region();
    const bool connected = state_->connected;
    recovery_.reset();
    take_over(std::move(file), project_);
    use_ = std::move(use);
    selection_.select_spot(spot);
    selection_.select_region(region);
    if (connected) worker_.connect_devices();
    return {};
}

void Desk::close() {
    sign_out("signed out: the project was closed");
    worker_.close();
    drop_kept();
    recovery_writer_.close();
    file_.reset();
    use_.reset();
    recovery_.reset();
    project_ = {};
    facts_ = {};
    undo_.clear();
    restored_ = false;
    derive();
    emit opened();
    emit project_changed();
}

}  // namespace seamwright
