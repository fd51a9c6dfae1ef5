#pragma once
// A studio of its own with its window, its settings in a folder that goes with it.

#include <gtest/gtest.h>
#include <unistd.h>

#include <QDockWidget>
#include <QDropEvent>
#include <QMimeData>
#include <QUrl>
#include <filesystem>
#include <memory>
#include <string>

#include "app/studio/main_window.h"
#include "app/studio/studio.h"

namespace seamwright {

class Furniture : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_window_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;

    void SetUp() override {
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        start(false);
    }
    ~Furniture() override {
        studio.reset();
        std::filesystem::remove_all(folder);
    }
    void start(bool connect, const QString& language = "en") {
        studio.reset();
        StudioOptions o;
        o.language = language;
        o.theme = "light";
        o.settings = path("settings.ini");
        o.data = path("");
        o.connect = connect;
        studio = std::make_unique<Studio>(*qApp, o);
        studio->window().resize(1280, 800);
        QApplication::setActiveWindow(&window());
        QApplication::processEvents();
    }
    QString path(const std::string& name) const { return QString::fromStdString((folder / name).string()); }
    MainWindow& window() { return studio->window(); }
    QDockWidget* dock(const char* name) { return window().findChild<QDockWidget*>(name); }
    // Drops a file onto the window; false: the window does not take it.
    bool drop(const QString& file) {
        QMimeData data;
        data.setUrls({QUrl::fromLocalFile(file)});
        const QPoint at(200, 200);
        QDragEnterEvent enter(at, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        enter.ignore();
        QApplication::sendEvent(&window(), &enter);
        if (!enter.isAccepted()) return false;
        QDropEvent event(at, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&window(), &event);
        QApplication::processEvents();
        return true;
    }
};

}  // namespace seamwright
