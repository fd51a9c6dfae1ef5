// seamwright-docs FOLDER: the manual in German and English, as HTML and PDF, with pictures of the program's own window.

#include <QApplication>
#include <clocale>
#include <cstdio>
#include <filesystem>

#include "app/docs/book.h"
#include "app/docs/pictures.h"

namespace seamwright {
namespace {

Expected<void> write_manual(QApplication& application, const QString& language,
                            const std::filesystem::path& folder) {
    const std::string name = "manual_" + language.toStdString();
    const auto pictures = folder / ("pictures_" + language.toStdString());
    std::error_code failed;
    std::filesystem::create_directories(pictures, failed);
    if (failed) return file_error("the folder cannot be made", pictures.string());
    SEAM_OK(take_pictures(application, language, pictures));
    SEAM_OK(write_manual_html(language, pictures, folder / (name + ".html")));
    SEAM_OK(write_manual_pdf(language, pictures, folder / (name + ".pdf")));
    std::printf("%s\n%s\n", (folder / (name + ".html")).c_str(), (folder / (name + ".pdf")).c_str());
    return {};
}

}  // namespace
}  // namespace seamwright

int main(int argc, char** argv) {
    qputenv("QT_SCALE_FACTOR", "1");
    QApplication application(argc, argv);
    std::setlocale(LC_NUMERIC, "C");  // Qt has set the desktop's: libraries that parse "1.5" would read 1
    QApplication::setQuitOnLastWindowClosed(false);
    if (argc != 2) {
        std::fprintf(stderr, "usage: seamwright-docs FOLDER\n");
        return 2;
    }
    for (const char* language : {"de", "en"})
        if (const auto written = seamwright::write_manual(application, language, argv[1]); !written) {
            std::fprintf(stderr, "seamwright-docs: %s\n", written.error().sentence().c_str());
            return 3;
        }
    return 0;
}
