#include "app/studio/studio.h"

#include <QDateTime>
#include <QDir>
#include <QFileInfo>
#include <QLibraryInfo>
#include <QLocale>
#include <QMessageBox>
#include <QPushButton>
#include <QStandardPaths>
#include <chrono>

#include "app/studio/demo_project.h"
#include "app/studio/look.h"
#include "app/studio/main_window.h"
#include "devices/registry.h"
#include "widgets/shown_text.h"

// Outside of any namespace, as Qt wants it: a static library's resources are linked only when named.
static void link_resources() {
    Q_INIT_RESOURCE(icons);
    Q_INIT_RESOURCE(studio_translations);
}

namespace seamwright {
namespace {
constexpr int kRecent = 10;
}

Studio::Studio(QApplication& application, const StudioOptions& options)
    : application_(application), options_(options) {
    link_resources();
    application_.installEventFilter(&plain_words_);
    application_.installEventFilter(&wheel_guard_);
    application_.installEventFilter(&list_habits_);
    settings_ = options.settings.isEmpty()
                    ? std::make_unique<QSettings>(QStringLiteral("seamwright"), QStringLiteral("studio"))
                    : std::make_unique<QSettings>(options.settings, QSettings::IniFormat);
    language_ = !options.language.isEmpty()
                    ? options.language
                    : settings_->value("language", QLocale::system().name().left(2)).toString();
    if (language_ != "de") language_ = "en";
    dark_ = options.theme.isEmpty() ? settings_->value("dark", false).toBool() : options.theme == "dark";
    apply_look(application_, dark_);
    set_language(language_);
    window_->show();
    if (!options.file.isEmpty())
        open(options.file);
    else
        open_demo(false);
}

Studio::~Studio() = default;

QString Studio::data_folder() const {
    const QString folder = options_.data.isEmpty()
                               ? QStandardPaths::writableLocation(QStandardPaths::AppDataLocation)
                               : options_.data;
    QDir().mkpath(folder);
    return folder;
}

void Studio::build_window() {
    const bool shown = window_ && window_->isVisible();
    const Step step = window_ ? window_->step() : Step::cell;
    if (window_) {
        window_->remember();
        window_->hide();
    }
    window_ = std::make_unique<MainWindow>(*this);
    window_->show_step(step);
    if (shown) window_->show();
}

void Studio::set_language(const QString& language) {
    language_ = language;
    settings_->setValue("language", language);
    application_.removeTranslator(&texts_);
    application_.removeTranslator(&qt_texts_);
    if (language == "de") {
        if (texts_.load(":/translations/seamwright_de.qm")) application_.installTranslator(&texts_);
        if (qt_texts_.load("qtbase_de", QLibraryInfo::path(QLibraryInfo::TranslationsPath)))
            application_.installTranslator(&qt_texts_);
    }
    QLocale::setDefault(QLocale(language == "de" ? QLocale::German : QLocale::English));
    set_shown_language(language_ == "de" ? Language::german : Language::english);
    desk_.set_language(language_ == "de" ? Language::german : Language::english);
    build_window();
}

void Studio::set_dark(bool dark) {
    dark_ = dark;
    settings_->setValue("dark", dark);
    apply_look(application_, dark);
    build_window();
}

QStringList Studio::recent() const {
    return settings_->value("recent").toStringList();
}

void Studio::remember(const QString& file) {
    QStringList files = recent();
    const QString path = QFileInfo(file).absoluteFilePath();
    files.removeAll(path);
    files.prepend(path);
    settings_->setValue("recent", files.mid(0, kRecent));
}

bool Studio::open(const QString& file) {
    if (auto opened = desk_.open(QFileInfo(file).absoluteFilePath().toStdString()); !opened) {
        emit desk_.trouble(shown_error(tr("The project was not opened."), opened.error()));
        return false;
    }
    remember(file);
    if (desk_.recovery()) ask_restore();
    const auto& sensors = desk_.project().sensors;
    const bool simulated =
        !sensors.empty() && std::all_of(sensors.begin(), sensors.end(),
                                        [](const SensorSetup& s) { return is_simulated_cell(s.driver); });
    // A simulated cell is there at once. Real devices are connected by a person.
    if (simulated && options_.connect) desk_.worker().connect_devices();
    window_->begin_at_next();
    return true;
}

bool Studio::create(const QString& file) {
    Project project;
    project.name = QFileInfo(file).completeBaseName().toStdString();
    if (auto made = desk_.create(QFileInfo(file).absoluteFilePath().toStdString(), project); !made) {
        emit desk_.trouble(shown_error(tr("The project was not made."), made.error()));
        return false;
    }
    remember(file);
    window_->show_step(Step::cell);
    return true;
}

bool Studio::open_demo(bool fresh) {
    const QString file = data_folder() + "/demo.seam";
    if (!fresh && QFileInfo::exists(file)) return open(file);
    const auto project = demo_project();
    if (!project) {
        emit desk_.trouble(shown_error(project.error()));
        return false;
    }
    if (auto made = desk_.create(file.toStdString(), *project); !made) {
        emit desk_.trouble(shown_error(tr("The project was not made."), made.error()));
        return false;
    }
    remember(file);
    if (options_.connect) desk_.worker().connect_devices();
    window_->begin_at_next();
    return true;
}

void Studio::ask_restore() {
    const Recovery& recovery = *desk_.recovery();
    using namespace std::chrono;
    const auto age = file_clock::now() - recovery.written;
    const QDateTime when = QDateTime::currentDateTime().addMSecs(-duration_cast<milliseconds>(age).count());
    QMessageBox box(QMessageBox::Question, tr("Restore unsaved edits?"),
                    tr("The last session ended without saving. Its edits of %1 are still there:")
                        .arg(when.toString("dd.MM.yyyy HH:mm:ss")),
                    QMessageBox::NoButton, window_.get());
    box.setObjectName("restore_question");
    const QStringList shown = recovery.holds.mid(0, 12);
    box.setInformativeText(shown.join("\n") + (recovery.holds.size() > 12
                                                   ? tr("\nand %1 more").arg(recovery.holds.size() - 12)
                                                   : QString()));
    QPushButton* restore = box.addButton(tr("Restore"), QMessageBox::AcceptRole);
    QPushButton* saved = box.addButton(tr("Open as saved"), QMessageBox::DestructiveRole);
    restore->setToolTip(tr("The edits come back; save keeps them"));
    saved->setToolTip(tr("The edits are thrown away"));
    restore->setObjectName("restore");
    box.setDefaultButton(restore);
    box.setEscapeButton(restore);
    box.exec();
    if (box.clickedButton() == saved)
        desk_.forget_recovery();
    else
        desk_.restore();
}

}  // namespace seamwright
