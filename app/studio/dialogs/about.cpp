#include "app/studio/dialogs/about.h"

#include <QCoreApplication>
#include <QMessageBox>

namespace seamwright {
namespace {

struct Library {
    const char *name, *licence;
};
constexpr Library kLibraries[] = {{"Qt 6, QCustomPlot", "LGPL 3, GPL 3"},
                                  {"VTK, OpenCV, PCL, Eigen", "BSD 3, Apache 2, BSD 3, MPL 2"},
                                  {"Ceres Solver, Boost, fmt, spdlog", "BSD 3, BSL 1, MIT, MIT"},
                                  {"Aravis, protobuf", "LGPL 2.1, BSD 3"},
                                  {"nlohmann/json, pugixml, CLI11, tl::expected", "MIT, MIT, BSD 3, CC0"},
                                  {"SQLite", "public domain"}};

}  // namespace

void show_about(QWidget* parent) {
    QString libraries;
    for (const Library& l : kLibraries)
        libraries += QStringLiteral("<tr><td>%1</td><td style='padding-left:16px'>%2</td></tr>")
                         .arg(QString::fromUtf8(l.name), QString::fromUtf8(l.licence));
    QMessageBox box(parent);
    box.setObjectName("about_box");
    box.setWindowTitle(QCoreApplication::translate("About", "About Seamwright"));
    box.setTextFormat(Qt::RichText);
    const QString text =
        QStringLiteral("<h2>Seamwright %1</h2><p>%2</p><p>%3</p><table>%4</table>")
            .arg(QStringLiteral(SEAMWRIGHT_VERSION),
                 QCoreApplication::translate(
                     "About",
                     "Robot path correction with laser-stripe sensors: calibrate, teach, align, prove, run."),
                 QCoreApplication::translate("About", "Built on these libraries, and their licences:"),
                 libraries);
    box.setText(text);
    box.setStandardButtons(QMessageBox::Ok);
    box.exec();
}

}  // namespace seamwright
