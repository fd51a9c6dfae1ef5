// Every text that a user sees is translated: no literal reaches a widget but through tr(), and what the
// layers below call their settings, kinds and states has a word in the window's language.
#include <gmock/gmock.h>

#include <QCoreApplication>
#include <QTranslator>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/correction/correction.h"
#include "core/features/feature.h"
#include "devices/registry.h"
#include "projects/model/run.h"
#include "projects/station/fields.h"
#include "widgets/error_texts.h"
#include "widgets/errors.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

// What shows text, and which of its arguments do (empty: all).
const std::map<std::string, std::set<int>> kSinks = {
    {"setText", {}},
    {"setToolTip", {}},
    {"setWindowTitle", {}},
    {"setAccessibleName", {}},
    {"setAccessibleDescription", {}},
    {"setPlaceholderText", {}},
    {"setInformativeText", {}},
    {"setDetailedText", {}},
    {"setStatusTip", {}},
    {"setWhatsThis", {}},
    {"setTitle", {}},
    {"setLabel", {}},
    {"setFormat", {}},
    {"setSuffix", {}},
    {"setPrefix", {}},
    {"setSpecialValueText", {}},
    {"setHorizontalHeaderLabels", {}},
    {"setHeaderLabels", {}},
    {"addMenu", {}},
    {"addToolBar", {}},
    {"addButton", {}},
    {"addTab", {}},
    {"addRow", {}},
    {"addAction", {}},
    {"addTick", {}},
    {"showMessage", {}},
    {"drawText", {}},
    {"setName", {}},
    {"make_text", {}},
    {"make_heading", {}},
    {"make_button", {2, 3}},
    {"make_table", {1, 2}},
    {"set_verdict", {1}},
    {"add_field", {1, 3}},
    {"action", {2}},
    {"add_dock", {1}},
    {"set_caption", {}},
    {"set_rows", {}},
    {"tell", {}},
    {"trouble", {}},
    {"say", {0, 1}},
    {"QLabel", {}},
    {"QPushButton", {}},
    {"QCheckBox", {}},
    {"QRadioButton", {}},
    {"QGroupBox", {}},
    {"QMessageBox", {}},
    {"question", {}},
    {"warning", {}},
    {"information", {}},
    {"critical", {}},
    {"getText", {}},
    {"getItem", {}},
    {"getInt", {}},
    {"getDouble", {}},
    {"getSaveFileName", {1, 3}},
    {"getOpenFileName", {1, 3}},
    {"getOpenFileNames", {1, 3}},
    {"getExistingDirectory", {1}},
    {"post", {0}},
};

// Inside of these a literal is translated, or a name that no one sees.
const std::set<std::string> kTranslating = {
    "tr", "translate", "QT_TRANSLATE_NOOP", "findChild", "toString", "value", "join", "icon", "property"};
const std::string kBody = "{";

// Signs and units that read the same everywhere.
bool neutral(std::string text) {
    static const std::regex escape(R"(\\[nt"\\]|%[0-9n])"), unit(R"(\b(mm|px|Hz|us|dB|dx|dz|min|max)\b)"),
        word(R"([A-Za-z]{2})");
    text = std::regex_replace(text, escape, " ");
    text = std::regex_replace(text, unit, " ");
    return !std::regex_search(text, word);
}

// Literals in the sinks' arguments that are in no call of tr(), translate() or shown_word(). Comments and raw
// strings (style sheets) are left out.
std::vector<std::string> untranslated(const std::string& source) {
    std::vector<std::string> found;
    struct Call {
        std::string name;
        int argument = 0;
    };
    std::vector<Call> calls;
    std::string word;
    int line = 1;
    char before = ' ';  // the last sign that is no blank
    for (std::size_t i = 0; i < source.size(); ++i) {
        const char c = source[i];
        if (c == '\n') ++line;
        if (c == '/' && i + 1 < source.size() && source[i + 1] == '/') {
            while (i < source.size() && source[i] != '\n') ++i;
            ++line;
            continue;
        }
        if (c == '#' && (i == 0 || source[i - 1] == '\n')) {  // include
            while (i < source.size() && source[i] != '\n') ++i;
            ++line;
            continue;
        }
        if (c == '\'') {
            i += source[i + 1] == '\\' ? 3 : 2;
            continue;
        }
        if (c == '"' && i > 0 && source[i - 1] == 'R') {
            i = source.find(")\"", i) + 1;
            continue;
        }
        if (c == '"') {
            std::string text;
            for (++i; i < source.size() && source[i] != '"'; ++i) {
                text += source[i];
                if (source[i] == '\\') text += source[++i];
            }
            // The innermost call that is known decides; a lambda's body is code of its own.
            std::string sink;
            for (auto call = calls.rbegin(); call != calls.rend() && call->name != kBody; ++call) {
                if (kTranslating.count(call->name) || call->name.ends_with("_error")) break;
                const auto it = kSinks.find(call->name);
                if (it == kSinks.end()) continue;
                if (it->second.empty() || it->second.count(call->argument)) sink = call->name;
                break;
            }
            if (!sink.empty() && !neutral(text))
                found.push_back(std::to_string(line) + ": " + sink + "(\"" + text + "\")");
            continue;
        }
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
            word += c;
            before = c;
            continue;
        }
        if (c == '(' || c == '{' || c == '[') {
            const bool body = c == '{' && (before == ')' || before == ']');
            calls.push_back({body ? kBody : c == '(' ? word : std::string(), 0});
        } else if ((c == ')' || c == '}' || c == ']') && !calls.empty()) {
            calls.pop_back();
        } else if (c == ',' && !calls.empty()) {
            ++calls.back().argument;
        }
        word.clear();
        if (c != ' ' && c != '\n') before = c;
    }
    return found;
}

TEST(Texts, TheScanFindsWhatIsNotTranslated) {
    EXPECT_EQ(untranslated("label->setText(\"Hello\");").size(), 1U);
    EXPECT_EQ(untranslated("label->setText(QStringLiteral(\"Hello\") + x);").size(), 1U);
    EXPECT_EQ(untranslated("new QLabel(\"Hello\", this);").size(), 1U);
    EXPECT_EQ(untranslated("make_button(\"name\", \"icon\", \"Hello\", tr(\"tip\"), f);").size(), 1U);
    EXPECT_EQ(untranslated("QMessageBox::question(this, tr(\"a\"), \"Hello\");").size(), 1U);
    EXPECT_EQ(untranslated("label->setText(tr(\"Hello\"));").size(), 0U);
    EXPECT_EQ(untranslated("label->setText(tr(\"a (b)\").arg(x) + \" mm\");  // \"Hello\"").size(), 0U);
    EXPECT_EQ(untranslated("make_button(\"name\", \"icon\", tr(\"Hello\"), tr(\"tip\"), f);").size(), 0U);
    EXPECT_EQ(untranslated("w->setObjectName(\"Hello\");").size(), 0U);
}

TEST(Texts, NoLiteralReachesAWidgetUntranslated) {
    int files = 0;
    for (const char* folder : {"app/studio", "widgets"})
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(SEAMWRIGHT_SOURCE) / folder)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
            ++files;
            std::ostringstream text;
            text << std::ifstream(entry.path()).rdbuf();
            for (const std::string& one : untranslated(text.str()))
                ADD_FAILURE() << fs::relative(entry.path(), SEAMWRIGHT_SOURCE).string() << ":" << one;
        }
    EXPECT_GT(files, 60);
}

TEST(Texts, WhatTheLayersBelowSayHasAWord) {
    std::ostringstream text;
    text << std::ifstream(fs::path(SEAMWRIGHT_SOURCE) / "resources/translations/seamwright_de.ts").rdbuf();
    const std::string german = std::regex_replace(std::regex_replace(text.str(), std::regex("&apos;"), "'"),
                                                  std::regex("&gt;"), ">");
    const auto sentence = [&](std::string_view english) {
        EXPECT_NE(german.find("<source>" + std::string(english) + "</source>"), std::string::npos) << english;
    };
    const auto setting = [&](const ParameterInfo& info) {
        EXPECT_TRUE(has_word(info.name)) << info.name << " is missing in widgets/words.cpp";
        for (const std::string& choice : info.choices) EXPECT_TRUE(has_word(choice)) << choice;
        sentence(info.help);
    };
    for (const FeatureKind& kind : feature_kinds()) {
        EXPECT_TRUE(has_word(kind.name)) << kind.name;
        sentence(kind.help);
        for (const ParameterInfo& info : kind.parameters) setting(info);
    }
    for (const auto& field : spot_fields()) setting(field.info);
    for (const auto& field : region_fields()) setting(field.info);
    for (const auto& driver : sensor_drivers()) sentence(driver.help);
    for (const auto& driver : robot_drivers()) sentence(driver.help);
    for (int i = 0; i <= static_cast<int>(SpotStatus::no_feature); ++i)
        EXPECT_TRUE(has_word(to_string(static_cast<SpotStatus>(i))));
    for (const auto status : {PushStatus::not_pushed, PushStatus::written, PushStatus::failed,
                              PushStatus::restored, PushStatus::not_restored})
        EXPECT_TRUE(has_word(to_string(status)));
    for (const auto status : {CorrectionStatus::ok, CorrectionStatus::under_determined,
                              CorrectionStatus::over_limit, CorrectionStatus::not_converged})
        EXPECT_TRUE(has_word(to_string(status)));
    for (const auto mode : {RobotMode::unknown, RobotMode::manual_reduced, RobotMode::manual_full,
                            RobotMode::automatic, RobotMode::external, RobotMode::stopped, RobotMode::fault})
        EXPECT_TRUE(has_word(to_string(mode)));
    for (const auto status : {FeatureStatus::ok, FeatureStatus::no_points, FeatureStatus::not_found,
                              FeatureStatus::ambiguous, FeatureStatus::ill_conditioned})
        EXPECT_TRUE(has_word(to_string(status)));
}

// The literals in the calls that make an Error, its place (the second argument) left out, cut where a number
// or a name goes in.
std::vector<std::string> error_pieces(const std::string& source) {
    static const std::regex call(R"(\b(input_error|usage_error|device_error|file_error|refuse)\s*\()"),
        gap(R"(\{[^{}]*\})");
    std::vector<std::string> pieces;
    for (std::sregex_iterator it(source.begin(), source.end(), call), end; it != end; ++it) {
        int depth = 1, argument = 0;
        std::string text;  // of literals that stand side by side
        const auto finish = [&] {
            if (argument != 1) {
                const std::string cut = std::regex_replace(text, gap, "\n");
                std::istringstream lines(cut);
                for (std::string line; std::getline(lines, line);) {
                    line.erase(0, line.find_first_not_of(" "));
                    line.erase(line.find_last_not_of(" ") + 1);
                    if (std::count(line.begin(), line.end(), ' ') > 0) pieces.push_back(line);
                }
            }
            text.clear();
        };
        for (auto i = static_cast<std::size_t>(it->position() + it->length()); i < source.size() && depth > 0;
             ++i) {
            const char c = source[i];
            if (c == '"') {
                for (++i; source[i] != '"'; ++i) {
                    if (source[i] == '\\') ++i;
                    text += source[i];
                }
                continue;
            }
            if (c == '\'') {
                i += source[i + 1] == '\\' ? 3 : 2;
                continue;
            }
            if (!std::isspace(static_cast<unsigned char>(c))) finish();
            if (c == '(' || c == '{' || c == '[') ++depth;
            if (c == ')' || c == '}' || c == ']') --depth;
            if (c == ',' && depth == 1) ++argument;
        }
    }
    return pieces;
}

TEST(Texts, TheScanFindsWhatAnErrorSays) {
    EXPECT_THAT(error_pieces("return input_error(\"no such \" \"spot\", \"where it is\", \"make it\");"),
                testing::ElementsAre("no such spot", "make it"));
    EXPECT_THAT(error_pieces("device_error(fmt::format(\"the {} of {} is late\", a, b), w());"),
                testing::ElementsAre("is late"));
}

TEST(Texts, WhatTheLayersBelowRefuseIsInTheList) {
    // What only the command line and the served devices of the tests reach is left out.
    const std::set<std::string> elsewhere = {"devices/abb/program.cpp",
                                             "devices/abb/egm_controller.cpp",
                                             "devices/genicam/served_camera.cpp",
                                             "devices/genicam/wire_camera.cpp",
                                             "devices/kuka/program.cpp",
                                             "devices/kuka/rsi_controller.cpp",
                                             "devices/kuka/rsi_program.cpp",
                                             "devices/ur/program.cpp",
                                             "devices/exchange/path_csv.cpp",
                                             "devices/cyclic/measuring.cpp",
                                             "projects/panel/panel_measure.cpp",
                                             "projects/acceptance/studies.cpp",
                                             "projects/acceptance/stored_values.cpp",
                                             "projects/panel/panel_station.cpp",
                                                                                          "projects/station/path.cpp",
                                             "projects/station/program.cpp",
                                             "projects/reuse/import_folder.cpp",
                                             "projects/calibrate/example.cpp",
                                             "devices/exchange/point_table.cpp",
                                             "devices/exchange/point_formats.cpp",
                                             "devices/exchange/pose_table.cpp",
                                             "devices/exchange/profile_layout.cpp",
                                             "devices/replay/recording_layout.cpp",
                                             "projects/station/watch.cpp",
                                             "projects/panel/gap_check.cpp",
                                             "core/features/gap_scan.cpp"};
    std::string listed = "\n";
    for (const char* text : error_texts()) listed += text + std::string("\n");
    listed = std::regex_replace(listed, std::regex("%[1-9]"), " ");
    listed = std::regex_replace(listed, std::regex(" +"), " ");
    int pieces = 0;
    for (const char* folder :
         {"core/alignment", "core/calibration", "core/features", "core/profile", "devices/abb",
          "devices/capture", "devices/cyclic", "devices/exchange", "devices/genicam", "devices/gocator",
          "devices/kuka", "devices/net", "devices/replay", "devices/ur", "projects"})
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(SEAMWRIGHT_SOURCE) / folder)) {
            const std::string name = fs::relative(entry.path(), SEAMWRIGHT_SOURCE).string();
            if (entry.path().extension() != ".cpp" || elsewhere.count(name)) continue;
            std::ostringstream text;
            text << std::ifstream(entry.path()).rdbuf();
            std::string source = text.str();
            if (name.starts_with("core/features/"))  // why a feature is not there
                source = std::regex_replace(source, std::regex(R"re(\bmessage\s*=\s*((?:[^;"]|"[^"]*")*);)re"), "refuse($1);");
            for (const std::string& piece : error_pieces(source)) {
                if (piece.find("%time") != std::string::npos) continue;  // the sensor's own placeholders
                ++pieces;
                EXPECT_NE(listed.find(piece), std::string::npos)
                    << name << ": \"" << piece << "\" is missing in widgets/error_texts.cpp";
            }
        }
    EXPECT_GT(pieces, 800);
}

// The German of the studio, read from its source.
class German : public QTranslator {
  public:
    German() {
        std::ostringstream file;
        file
            << std::ifstream(fs::path(SEAMWRIGHT_SOURCE) / "resources/translations/seamwright_de.ts").rdbuf();
        QString ts = QString::fromStdString(file.str());
        ts = ts.mid(ts.indexOf("<name>Errors</name>"));
        ts.truncate(ts.indexOf("</context>"));
        for (const QString& message : ts.split("</message>")) {
            const auto part = [&](const QString& tag) {
                QString text = message.section("<" + tag + ">", 1, 1).section("</" + tag + ">", 0, 0);
                for (const auto& [code, sign] : {std::pair("&quot;", "\""),
                                                 {"&apos;", "'"},
                                                 {"&lt;", "<"},
                                                 {"&gt;", ">"},
                                                 {"&amp;", "&"}})
                    text.replace(code, sign);
                return text;
            };
            german_[part("source")] = part("translation");
        }
    }
    QString translate(const char* context, const char* source, const char*, int) const override {
        return QString(context) == "Errors" ? german_.value(source) : QString();
    }
    bool isEmpty() const override { return german_.isEmpty(); }

  private:
    QHash<QString, QString> german_;
};

TEST(Texts, AnErrorIsGermanFromPlaceToCure) {
    int count = 0;
    QCoreApplication application(count, nullptr);
    German german;
    ASSERT_TRUE(QCoreApplication::installTranslator(&german));
    const auto shown = [](const Error& error) { return shown_error(error).toStdString(); };
    EXPECT_EQ(shown({ErrorKind::device, "no answer in time: no frame within 500 ms", "sensor A",
                     "let the robot measure or trigger the sensor"}),
              "Sensor A: keine Antwort in der Zeit: kein Bild in 500 ms; den Roboter messen lassen "
              "oder den Sensor auslösen");
    EXPECT_EQ(shown({ErrorKind::input, "camera and laser plane is not known", "sensor A: stripe-camera", ""}),
              "Sensor A: stripe-camera: Kamera und Laserebene: nicht bekannt");
    EXPECT_EQ(shown({ErrorKind::file, "the project file is damaged", "/tmp/sensor 1.seam", ""}),
              "/tmp/sensor 1.seam: Projektdatei: beschädigt");
    EXPECT_EQ(shown({ErrorKind::input, "no board of 7x6 points was found in any of 12 images", "board", ""}),
              "Tafel: in keinem von 12 Bildern wurde eine Tafel mit 7x6 Punkten gefunden");
    EXPECT_EQ(shown({ErrorKind::input, "there is no spot \"project\"", "", ""}),
              "es gibt keine Messstelle „project“")
        << "names stay as they were given";
    EXPECT_EQ(shown({ErrorKind::device, "Errno 1234 %1", "10.0.0.1:502", ""}), "10.0.0.1:502: Errno 1234 %1")
        << "what others say stays as it is";
    EXPECT_EQ(shown_cause("rotation about X through (528.2, 674.9, -33.9)").toStdString(),
              "Drehung um X durch (528.2, 674.9, -33.9) mm");
    EXPECT_EQ(shown_cause("the spots do not determine the translation along Z: add a spot whose edge runs in "
                          "another direction")
                  .toStdString(),
              "die Messstellen bestimmen nicht: Verschiebung entlang Z; eine Messstelle hinzufügen, deren "
              "Kante in eine andere Richtung verläuft");
    QCoreApplication::removeTranslator(&german);
}

}  // namespace
}  // namespace seamwright
