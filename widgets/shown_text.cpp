#include "widgets/shown_text.h"

#include <atomic>

namespace seamwright {
namespace {

std::atomic<Language> language = Language::english;

}  // namespace

void set_shown_language(Language chosen) {
    language = chosen;
}

QString shown(const Text& text) {
    return QString::fromStdString(text.in(language));
}

QString shown_error(const Error& error) {
    return shown(error.text());
}

QString shown_error(const QString& frame, const Error& error) {
    return frame + QStringLiteral(" ") + shown_error(error);
}

}  // namespace seamwright
