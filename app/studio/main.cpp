// seamwright-studio [FILE.seam]: the desk of the commissioning engineer.

#include <QCommandLineParser>
#include <QTimer>
#include <clocale>
#include <cstdio>
#include <cstring>

#include "app/studio/main_window.h"
#include "app/studio/studio.h"
#include "widgets/picture_file.h"

namespace {

// What the command line may hold.
class Arguments {
  public:
    Arguments() {
        parser.setApplicationDescription(QCoreApplication::translate(
            "main", "Teach, align, prove and run robot path correction with laser-stripe sensors."));
        parser.addHelpOption();
        parser.addVersionOption();
        parser.addPositionalArgument(
            "FILE.seam", QCoreApplication::translate("main", "project to open; without it the demo project"));
    }

  private:
    QCommandLineOption add(const char* name, const QString& help, const char* value) {
        QCommandLineOption option(name, help, value);
        parser.addOption(option);
        return option;
    }

  public:
    QCommandLineParser parser;
    const QCommandLineOption language =
        add("language", QCoreApplication::translate("main", "en or de"), "LANGUAGE");
    const QCommandLineOption theme =
        add("theme", QCoreApplication::translate("main", "light or dark"), "THEME");
    const QCommandLineOption size =
        add("size", QCoreApplication::translate("main", "of the window, e.g. 1280x800"), "WxH");
    const QCommandLineOption settings =
        add("settings", QCoreApplication::translate("main", "settings file instead of the user's"), "FILE");
    const QCommandLineOption data =
        add("data", QCoreApplication::translate("main", "folder for the demo project"), "DIR");
    const QCommandLineOption step =
        add("step", QCoreApplication::translate("main", "step to show, 1 to 8"), "N");
    const QCommandLineOption picture =
        add("screenshot",
            QCoreApplication::translate("main", "writes a picture of the window after 3 s and ends"), "PNG");
};

void name_application() {
    QCoreApplication::setApplicationName("studio");
    QCoreApplication::setOrganizationName("seamwright");
    QCoreApplication::setApplicationVersion(SEAMWRIGHT_VERSION);
}

// What is answered in words needs no window, and so no display.
bool asks_for_words(int argc, char** argv) {
    for (int i = 1; i < argc; ++i)
        for (const char* word : {"-h", "--help", "--help-all", "-v", "--version"})
            if (std::strcmp(argv[i], word) == 0) return true;
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    name_application();
    if (asks_for_words(argc, argv)) {
        const QCoreApplication application(argc, argv);
        QCoreApplication::setApplicationName("seamwright-studio");
        Arguments().parser.process(application);
        return 0;
    }
    QApplication application(argc, argv);
    std::setlocale(LC_NUMERIC, "C");  // Qt has set the desktop's: libraries that parse "1.5" would read 1
    QApplication::setApplicationDisplayName("Seamwright");
    QApplication::setQuitOnLastWindowClosed(false);  // the window is rebuilt when language or theme changes
    Arguments arguments;
    QCommandLineParser& parser = arguments.parser;
    parser.process(application);

    seamwright::StudioOptions options;
    options.language = parser.value(arguments.language);
    options.theme = parser.value(arguments.theme);
    options.settings = parser.value(arguments.settings);
    options.data = parser.value(arguments.data);
    if (!parser.positionalArguments().isEmpty()) options.file = parser.positionalArguments().front();
    seamwright::Studio studio(application, options);
    if (const QStringList wh = parser.value(arguments.size).split('x'); wh.size() == 2)
        studio.window().resize(wh[0].toInt(), wh[1].toInt());
    if (const int n = parser.value(arguments.step).toInt();
        n >= 1 && n <= static_cast<int>(seamwright::kSteps.size()))
        studio.window().show_step(seamwright::kSteps[static_cast<std::size_t>(n - 1)]);
    if (parser.isSet(arguments.picture))
        QTimer::singleShot(3000, &application, [&] {
            const auto written = seamwright::write_picture(studio.window().grab().toImage(),
                                                           parser.value(arguments.picture).toStdString());
            if (!written) std::fprintf(stderr, "seamwright-studio: %s\n", written.error().sentence().c_str());
            QApplication::exit(written ? 0 : 3);
        });
    return QApplication::exec();
}
