#pragma once
// What keeps unsaved edits: FILE.seam.recovery beside the project, itself a project file. Written on a thread
// of its own right after every edit, newest only; removed at save, and when undo returns to what was saved.
// It is there after a crash and only then.

#include <QObject>
#include <QStringList>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "projects/file/project_file.h"

namespace seamwright {

std::filesystem::path recovery_path(const std::filesystem::path& project_file);

struct Recovery {
    Project project;
    std::filesystem::file_time_type written;
    QStringList holds;  // what differs from the file, in words: "spot S3 added"
};
// nullopt: nothing to restore (no recovery file, or equal to the file's project). Error: there is one and it
// cannot be read (damaged, of a newer version, another program's).
Expected<std::optional<Recovery>> find_recovery(const std::filesystem::path& project_file,
                                                const Project& saved);
// Renames a recovery that cannot be read to FILE.seam.recovery.damaged (-2, -3, ... when there are such
// already): a person or a newer program may still get something out of it, and autosave needs its name.
// Returns the new path.
Expected<std::filesystem::path> set_aside_recovery(const std::filesystem::path& project_file);
void discard_recovery(const std::filesystem::path& project_file);

// What differs, a line each.
QStringList differences(const Project& before, const Project& after);

class RecoveryWriter : public QObject {
    Q_OBJECT
  public:
    explicit RecoveryWriter(QObject* parent = nullptr);
    ~RecoveryWriter() override;  // writes what is pending
    void open(const std::filesystem::path& project_file);
    void write(const Project& project);  // returns at once
    void flush();                        // waits until the newest is on the disk
    bool kept() const;                   // the newest one written is on the disk
    void clear();                        // nothing is unsaved: the recovery file goes away
    void close();

  signals:
    void written();
    void trouble(QString sentence);  // an edit is not kept, or a recovery that went bad was set aside for it

  private:
    void work(const std::stop_token& stop);
    mutable std::mutex mutex_;
    std::condition_variable_any wake_;
    std::filesystem::path target_;
    std::unique_ptr<Project> pending_;
    bool clear_ = false, busy_ = false, kept_ = false;
    std::jthread thread_;
};

}  // namespace seamwright
