#pragma once
// The program: one desk, one window, language, theme, recent files, and what is asked at start.

#include <QApplication>
#include <QSettings>
#include <QTranslator>
#include <memory>

#include "widgets/desk/desk.h"
#include "widgets/editors/list_habits.h"
#include "widgets/editors/plain_words.h"
#include "widgets/editors/wheel_guard.h"

namespace seamwright {

class MainWindow;

struct StudioOptions {
    QString file;      // to open; empty = the demo project
    QString language;  // "en", "de"; empty = as remembered, else the system's
    QString theme;     // "light", "dark"; empty = as remembered
    QString settings;  // an ini file instead of the user's settings
    QString data;      // a folder instead of the user's data folder
    bool connect = true;
};

class Studio : public QObject {
    Q_OBJECT
  public:
    explicit Studio(QApplication& application, const StudioOptions& options);
    ~Studio() override;

    Desk& desk() { return desk_; }
    QSettings& settings() { return *settings_; }
    MainWindow& window() { return *window_; }
    QString language() const { return language_; }
    bool dark() const { return dark_; }
    void set_language(const QString& language);  // builds the window anew
    void set_dark(bool dark);

    // Opens and, where a crash left edits, asks whether to restore them. An Error is shown in the window.
    bool open(const QString& file);
    bool create(const QString& file);  // an empty project
    bool open_demo(bool fresh);        // the user's copy; `fresh`: a new one
    QStringList recent() const;
    QString data_folder() const;

  private:
    void build_window();
    void remember(const QString& file);
    void ask_restore();

    QApplication& application_;
    StudioOptions options_;
    std::unique_ptr<QSettings> settings_;
    PlainWords plain_words_;
    WheelGuard wheel_guard_;
    ListHabits list_habits_;
    QTranslator texts_, qt_texts_;
    Desk desk_;
    std::unique_ptr<MainWindow> window_;
    QString language_;
    bool dark_ = false;
};

}  // namespace seamwright
