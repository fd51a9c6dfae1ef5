#include "app/docs/pictures.h"

#include <QAction>
#include <QApplication>
#include <QDeadlineTimer>
#include <QPushButton>
#include <QTemporaryDir>
#include <QThread>
#include <functional>

#include "app/manual/manual.h"
#include "app/studio/main_window.h"
#include "app/studio/studio.h"
#include "widgets/picture_file.h"

namespace seamwright {
namespace {

constexpr int kWidthPx = 1440, kHeightPx = 900;
constexpr int kMostMs = 60000, kSettleMs = 1200, kParts = 5;

bool wait_until(const std::function<bool()>& ready) {
    const QDeadlineTimer end(kMostMs);
    while (!ready()) {
        if (end.hasExpired()) return false;
        QApplication::processEvents(QEventLoop::AllEvents, 20);
        QThread::msleep(5);
    }
    return true;
}

void settle() {
    const QDeadlineTimer end(kSettleMs);
    wait_until([&] { return end.hasExpired(); });
}

Expected<void> grab(MainWindow& window, const QString& name, const std::filesystem::path& folder) {
    settle();
    return write_picture(window.grab().toImage(), folder / (name.toStdString() + ".png"));
}

}  // namespace

Expected<void> take_pictures(QApplication& application, const QString& language,
                             const std::filesystem::path& folder) {
    const QTemporaryDir own;  // neither the user's settings nor the user's demo project
    Studio studio(application, {.file = {},
                                .language = language,
                                .theme = "light",
                                .settings = own.filePath("settings.ini"),
                                .data = own.path(),
                                .connect = true});
    MainWindow& window = studio.window();
    window.resize(kWidthPx, kHeightPx);
    StationWorker& worker = studio.desk().worker();
    const auto action = [&](const char* name) { window.findChild<QAction*>(name)->trigger(); };
    const auto press = [&](const char* name) { window.findChild<QPushButton*>(name)->click(); };
    const auto idle = [&]() -> Expected<void> {
        settle();
        if (wait_until([&] { return !worker.busy(); })) return {};
        return device_error("the window did not come to rest", "pictures of the manual");
    };
    SEAM_OK(idle());
    press("place_part");
    SEAM_OK(idle());
    // History and charts have something to show.
    for (int part = 0; part < kParts; ++part) {
        action("measure_now");
        SEAM_OK(idle());
    }
    window.show_step(Step::align);
    press("start_pass");
    SEAM_OK(idle());
    window.show_step(Step::teach);
    SEAM_OK(grab(window, "start", folder));
    for (const Step step : kSteps) {
        window.show_step(step);
        SEAM_OK(grab(window, manual_page_of(step), folder));
    }
    return {};
}

}  // namespace seamwright
