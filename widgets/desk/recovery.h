#pragma once
// What keeps unsaved edits: FILE.seam.recovery beside the project, itself a project file. Written on a thread
// of its own right after every edit, newest only; removed at save. It is there after a crash and only then.

#include <QObject>
#include <QStringList>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "projects/project_file.h"

namespace seamwright {

std::filesystem::path recovery_path(const std::filesystem::path& project_file);

struct Recovery {
    Project project;
    std::filesystem::file_time_type written;
    QStringList holds;  // what differs from the file, in words: "spot S3 added"
};
// nullopt: nothing to restore (no recovery file, unreadable, or equal to the file's project).
std::optional<Recovery> find_recovery(const std::filesystem::path& project_file, const Project& saved);
void discard_recovery(const std::filesystem::path& project_file);

// What differs, a line each.
QStringList differences(const Project& before, const Project& after);
// Equal in everything that is stored.
bool same_project(const Project& a, const Project& b);

class RecoveryWriter : public QObject {
    Q_OBJECT
  public:
    explicit RecoveryWriter(QObject* parent = nullptr);
    ~RecoveryWriter() override;  // writes what is pending
    void open(const std::filesystem::path& project_file);
    void write(const Project& project);  // returns at once
    void flush();                        // waits until the newest is on the disk
    void clear();                        // after a save: the recovery file goes away
    void close();

  signals:
    void written();
    void failed(QString sentence);

  private:
    void work(const std::stop_token& stop);
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::filesystem::path target_;
    std::unique_ptr<Project> pending_;
    bool clear_ = false, busy_ = false;
    std::jthread thread_;
};

}  // namespace seamwright
