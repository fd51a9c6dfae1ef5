// Every text that a user sees is translated: no literal reaches a widget but through tr(), and what the
// layers below call their settings, kinds and states has a word in the window's language.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/correction/correction.h"
#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/text.h"
#include "devices/line/line_link.h"
#include "devices/registry.h"
#include "projects/measure/fields.h"
#include "projects/model/run.h"
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
    const auto sentence = [&](std::string_view english) {
        EXPECT_TRUE(german_of(english)) << english << " is missing in resources/translations/texts_de.json";
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
    for (const auto& field : requirement_fields())
        EXPECT_TRUE(field.info.unit.empty() || field.info.unit == "mm" || has_word(field.info.unit))
            << field.info.unit << " is missing in widgets/words.cpp";
    sentence("simulated gripper");
    const std::function<void(const SettingTable&)> of_driver = [&](const SettingTable& table) {
        for (const SettingInfo& info : table) {
            EXPECT_TRUE(has_word(info.name)) << info.name << " is missing in widgets/words.cpp";
            for (const std::string& choice : info.choices)
                EXPECT_TRUE(choice.empty() || has_word(choice))
                    << choice << " is missing in widgets/words.cpp";
            if (!info.help.empty()) sentence(info.help);
            of_driver(info.fields);
        }
    };
    for (const auto& driver : sensor_drivers()) {
        sentence(driver.help);
        of_driver(driver.settings());
    }
    for (const auto& driver : robot_drivers()) {
        sentence(driver.help);
        of_driver(driver.settings());
    }
    for (const auto& protocol : line_protocols()) of_driver(protocol.settings());
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

}  // namespace
}  // namespace seamwright
