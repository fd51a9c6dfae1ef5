#pragma once
// A desk with a project file, and what a crash at this instant would leave.

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QDeadlineTimer>
#include <functional>
#include <thread>

#include "tests/projects/sample_project.h"
#include "widgets/desk/desk.h"

namespace seamwright {

inline bool wait_until(const std::function<bool()>& ready, int patience_ms = 20000) {
    const QDeadlineTimer end(patience_ms);
    while (!ready()) {
        if (end.hasExpired()) return false;
        QCoreApplication::processEvents();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

// Everything that is stored, to the last bit.
inline std::string bits(const Project& project) {
    std::string text = exact_text(project);
    for (std::byte b : project.part.mesh_ply) text += static_cast<char>(b);
    return text;
}

// What the next start would find, read past the desk.
struct Left {
    Project saved;
    std::optional<Recovery> recovery;
    std::string unreadable;
};
inline Left what_a_crash_leaves(const std::filesystem::path& file) {
    Left left;
    auto opened = ProjectFile::open(file, FileAccess::read_only);
    EXPECT_TRUE(opened) << opened.error().sentence();
    if (!opened) return left;
    left.saved = opened->load().value();
    auto found = find_recovery(file, left.saved);
    if (found)
        left.recovery = std::move(*found);
    else
        left.unreadable = found.error().what.english();
    return left;
}

// A desk whose signals are counted.
struct WatchedDesk {
    Desk desk;
    int written = 0;
    QStringList troubles;
    WatchedDesk() {
        QObject::connect(&desk, &Desk::recovery_written, &desk, [this] { ++written; });
        QObject::connect(&desk, &Desk::trouble, &desk, [this](const QString& text) { troubles << text; });
    }
    // Renames the project and waits until that would survive a crash.
    void rename_and_wait(const std::string& name) {
        const int before = written;
        ASSERT_TRUE(desk.rename_project(name));
        ASSERT_TRUE(wait_until([&] { return written > before; })) << troubles.join("; ").toStdString();
    }
};

}  // namespace seamwright
