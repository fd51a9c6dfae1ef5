#include "tests/core/said_in_sources.h"

#include <algorithm>
#include <cctype>

namespace seamwright {
namespace {

bool of_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

struct Call {
    std::string name;
    int argument = 0;
};

// Whoever makes a Text of its arguments.
const std::set<std::string> kErrors = {"input_error", "usage_error", "device_error", "file_error"};
const std::set<std::string> kSayers = {
    "refuse_unless", "say",          "missing",          "done",    "give_up", "damaged", "broken",
    "refused",       "undetermined", "unless",           "failure", "raise",   "missed",  "Judgement",
    "Error",         "judgement",    "take_back_motion", "t",       "gap",     "remark",  "run_in_doubt"};
// The entries of tables of settings, and which argument their help is.
const std::map<std::string, int> kHelps = {{"number", 4}, {"whole", 4}, {"text", 2}, {"choice", 2},
                                           {"yes_no", 2}, {"pose", 1},  {"list", 2}, {"object", 2}};

bool has_letter(const std::string& text) {
    return std::any_of(text.begin(), text.end(),
                       [](char c) { return std::isalpha(static_cast<unsigned char>(c)); });
}

}  // namespace

std::vector<SourceLiteral> literals_of(const std::string& s) {
    std::vector<SourceLiteral> found;
    std::vector<Call> calls;
    std::string word, before;  // the name at hand and the one before it
    int line = 1;
    bool joins = false;  // nothing but blanks since the last literal
    for (std::size_t i = 0; i < s.size(); ++i) {
        const char c = s[i];
        if (c == '\n') ++line;
        if ((c == '/' && i + 1 < s.size() && s[i + 1] == '/') || (c == '#' && (i == 0 || s[i - 1] == '\n'))) {
            while (i < s.size() && s[i] != '\n') ++i;
            ++line;
            continue;
        }
        if (c == '\'' && (i == 0 || !of_name(s[i - 1]))) {
            i += s[i + 1] == '\\' ? 3 : 2;
            continue;
        }
        if (c == '"' && word == "R") {
            const std::size_t open = s.find('(', i);
            const std::string end = ")" + s.substr(i + 1, open - i - 1) + "\"";
            const std::size_t close = std::min(s.find(end, open), s.size());
            line += static_cast<int>(std::count(s.begin() + static_cast<std::ptrdiff_t>(i),
                                                s.begin() + static_cast<std::ptrdiff_t>(close), '\n'));
            i = close + end.size() - 1;
            word.clear();
            continue;
        }
        if (c == '"') {
            std::string text;
            for (++i; i < s.size() && s[i] != '"'; ++i) {
                if (s[i] != '\\') {
                    text += s[i];
                } else {
                    ++i;
                    text += s[i] == 'n' ? '\n' : s[i] == 't' ? '\t' : s[i];
                }
            }
            if (joins)
                found.back().text += text;
            else
                found.push_back({text, calls.empty() ? "" : calls.back().name,
                                 calls.empty() ? 0 : calls.back().argument, line});
            joins = true;
            continue;
        }
        if (std::isspace(static_cast<unsigned char>(c))) {
            if (!word.empty()) before = std::exchange(word, {});
            continue;
        }
        joins = false;
        if (of_name(c)) {
            word += c;
            continue;
        }
        if (c == '(' || c == '{' || c == '[') {
            // "Text why(...)" is one of a Text.
            const std::string name = word.empty() ? before : before == "Text" ? "Text" : word;
            calls.push_back({c == '[' ? "" : name, 0});
        } else if (c == ')' || c == '}' || c == ']') {
            if (!calls.empty()) calls.pop_back();
        } else if (c == ',' && !calls.empty()) {
            ++calls.back().argument;
        }
        word.clear();
        before.clear();
        // The name of what is filled in a list: "report.judgement = {...}".
        if (c == '=') {
            std::size_t end = i;
            while (end > 0 && s[end - 1] == ' ') --end;
            std::size_t begin = end;
            while (begin > 0 && of_name(s[begin - 1])) --begin;
            before = s.substr(begin, end - begin);
        }
    }
    return found;
}

bool is_setting_help(const SourceLiteral& l) {
    const auto help = kHelps.find(l.call);
    return help != kHelps.end() && l.argument == help->second && has_letter(l.text);
}

bool is_said(const SourceLiteral& l) {
    if (is_setting_help(l)) return true;
    const bool words = has_letter(l.text);
    const bool sentence = words && l.text.find(' ') != std::string::npos;
    if (l.call == "Text") return l.argument == 0 ? words : sentence;
    if (l.call == "chosen") return l.argument == 0 && words;
    return sentence && (kErrors.count(l.call) > 0 || kSayers.count(l.call) > 0);
}

}  // namespace seamwright
