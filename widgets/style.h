#pragma once
// Colours and digits of all views. Light or dark follows from the widget's palette; meaning from the
// Okabe-Ito set, which people with colour blindness can tell apart. A colour never stands alone: a word, a
// shape or a thickness says the same.

#include <QColor>
#include <QFont>
#include <QPalette>
#include <array>

namespace seamwright::style {

// Okabe and Ito (2008).
inline constexpr QRgb kBluishGreen = 0xff009e73, kOrange = 0xffe69f00, kVermilion = 0xffd55e00,
                      kBlue = 0xff0072b2, kSkyBlue = 0xff56b4e9, kReddishPurple = 0xffcc79a7,
                      kYellow = 0xfff0e442;

inline bool is_dark(const QPalette& palette) {
    return palette.color(QPalette::Base).lightness() < 128;
}

// Fills and marks keep the set's own tone; text needs 4.5:1 against the window and is darker or lighter.
inline QColor good(const QPalette& p) {
    return is_dark(p) ? QColor(0x3ddbaa) : QColor(0x00704f);
}
inline QColor attention(const QPalette& p) {
    return is_dark(p) ? QColor(0xf0b429) : QColor(0x8a5a00);
}
inline QColor alarm(const QPalette& p) {
    return is_dark(p) ? QColor(0xff8a4c) : QColor(0xb04400);
}
inline QColor selection(const QPalette& p) {
    return is_dark(p) ? QColor(0x6cc4f5) : QColor(0x0067a3);
}
inline QColor text(const QPalette& p) {
    return p.color(QPalette::WindowText);
}
inline QColor quiet_text(const QPalette& p) {
    return is_dark(p) ? QColor(0xb3bac2) : QColor(0x4d565f);
}
inline QColor axis(const QPalette& p) {
    return is_dark(p) ? QColor(0x8b949e) : QColor(0x6b747d);
}
inline QColor grid(const QPalette& p) {
    return is_dark(p) ? QColor(0x31373e) : QColor(0xe3e7eb);
}
inline QColor plot_ground(const QPalette& p) {
    return p.color(QPalette::Base);
}
inline QColor outlier(const QPalette& p) {
    return is_dark(p) ? QColor(0xff8a4c) : QColor(0xb04400);
}

// Segment n of a profile. Neighbouring numbers differ in lightness as well as in hue.
inline QColor segment(int number, const QPalette& p) {
    static constexpr std::array<QRgb, 5> on_light{0xff0067a3, 0xff00805c, 0xff7d3560, 0xffa87600, 0xff00527f};
    static constexpr std::array<QRgb, 5> on_dark{0xff6cc4f5, 0xff2bbd90, 0xfff0e442, 0xffe59cc3, 0xff4da3ff};
    const auto& set = is_dark(p) ? on_dark : on_light;
    return QColor::fromRgb(set[static_cast<std::size_t>(number < 0 ? 0 : number) % set.size()]);
}

// The window's two grounds: not white, not black.
inline QPalette light_palette() {
    QPalette p;
    p.setColor(QPalette::Window, QColor(0xf6f7f8));
    p.setColor(QPalette::Base, QColor(0xfdfdfd));
    p.setColor(QPalette::AlternateBase, QColor(0xeef0f2));
    p.setColor(QPalette::Button, QColor(0xe9ecef));
    for (const auto role :
         {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
        p.setColor(role, QColor(0x1b1f24));
    p.setColor(QPalette::ToolTipBase, QColor(0xffffff));
    p.setColor(QPalette::Mid, QColor(0xb8bfc6));
    p.setColor(QPalette::Highlight, QColor(0x0067a3));
    p.setColor(QPalette::HighlightedText, Qt::white);
    p.setColor(QPalette::PlaceholderText, QColor(0x59636d));
    p.setColor(QPalette::Link, QColor(0x0067a3));
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
        p.setColor(QPalette::Disabled, role, QColor(0x606972));
    return p;
}

inline QPalette dark_palette() {
    QPalette p;
    p.setColor(QPalette::Window, QColor(0x1e2226));
    p.setColor(QPalette::Base, QColor(0x171a1e));
    p.setColor(QPalette::AlternateBase, QColor(0x252a30));
    p.setColor(QPalette::Button, QColor(0x2b3138));
    for (const auto role :
         {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
        p.setColor(role, QColor(0xe8ebee));
    p.setColor(QPalette::ToolTipBase, QColor(0x2b3138));
    p.setColor(QPalette::Mid, QColor(0x4a525b));
    p.setColor(QPalette::Light, QColor(0x3a424b));
    p.setColor(QPalette::Dark, QColor(0x14171a));
    p.setColor(QPalette::Highlight, QColor(0x2374a8));
    p.setColor(QPalette::HighlightedText, Qt::white);
    p.setColor(QPalette::PlaceholderText, QColor(0x98a1aa));
    p.setColor(QPalette::Link, QColor(0x6cc4f5));
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
        p.setColor(QPalette::Disabled, role, QColor(0x98a1aa));
    return p;
}

inline constexpr int kTargetPx = 32;  // smallest size of what is touched
inline constexpr int kTextPt = 11;    // smallest text

}  // namespace seamwright::style
