// seamwright-studio [FILE.seam]: the desk of the commissioning engineer.

#include <QCommandLineParser>
#include <QTimer>
#include <clocale>
#include <cstdio>

#include "app/studio/main_window.h"
#include "app/studio/studio.h"
#include "widgets/picture_file.h"

int main(int argc, char** argv) {
    QApplication application(argc, argv);
    std::setlocale(LC_NUMERIC, "C");  // Qt has set the desktop's: libraries that parse "1.5" would read 1
    QApplication::setApplicationName("studio");
    QApplication::setOrganizationName("seamwright");
    QApplication::setApplicationDisplayName("Seamwright");
    QApplication::setQuitOnLastWindowClosed(false);  // the window is rebuilt when language or theme changes
    QCommandLineParser parser;
    parser.setApplicationDescription(QApplication::translate(
        "main", "Teach, align, prove and run robot path correction with laser-stripe sensors."));
    parser.addHelpOption();
    parser.addPositionalArgument(
        "FILE.seam", QApplication::translate("main", "project to open; without it the demo project"));
    const auto option = [&](const char* name, const QString& help, const char* value) {
        QCommandLineOption o(name, help, value);
        parser.addOption(o);
        return o;
    };
    const auto language = option("language", QApplication::translate("main", "en or de"), "LANGUAGE");
    const auto theme = option("theme", QApplication::translate("main", "light or dark"), "THEME");
    const auto size = option("size", QApplication::translate("main", "of the window, e.g. 1280x800"), "WxH");
    const auto settings =
        option("settings", QApplication::translate("main", "settings file instead of the user's"), "FILE");
    const auto data = option("data", QApplication::translate("main", "folder for the demo project"), "DIR");
    const auto step = option("step", QApplication::translate("main", "step to show, 1 to 8"), "N");
    const auto picture =
        option("screenshot",
               QApplication::translate("main", "writes a picture of the window after 3 s and ends"), "PNG");
    parser.process(application);

    seamwright::StudioOptions options;
    options.language = parser.value(language);
    options.theme = parser.value(theme);
    options.settings = parser.value(settings);
    options.data = parser.value(data);
    if (!parser.positionalArguments().isEmpty()) options.file = parser.positionalArguments().front();
    seamwright::Studio studio(application, options);
    if (const QStringList wh = parser.value(size).split('x'); wh.size() == 2)
        studio.window().resize(wh[0].toInt(), wh[1].toInt());
    if (const int n = parser.value(step).toInt(); n >= 1 && n <= static_cast<int>(seamwright::kSteps.size()))
        studio.window().show_step(seamwright::kSteps[static_cast<std::size_t>(n - 1)]);
    if (parser.isSet(picture))
        QTimer::singleShot(3000, &application, [&] {
            const auto written = seamwright::write_picture(studio.window().grab().toImage(),
                                                           parser.value(picture).toStdString());
            if (!written) std::fprintf(stderr, "seamwright-studio: %s\n", written.error().sentence().c_str());
            QApplication::exit(written ? 0 : 3);
        });
    return QApplication::exec();
}
