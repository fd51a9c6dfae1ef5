#pragma once
// The few shapes that all pages are made of: buttons of finger size with icon, word and tooltip, labelled
// rows, read-only tables.

#include <QIcon>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <array>
#include <functional>
#include <optional>

#include "core/calibration/verdict.h"
#include "core/geometry/pose.h"

namespace seamwright {

// resources/icons/<name>.svg in the colour of the palette's text.
QIcon icon(const QString& name, const QPalette& palette);

// `name` is the object name, for tests and style.
QPushButton* make_button(const QString& name, const QString& icon_name, const QString& text,
                         const QString& tip, const std::function<void()>& clicked);
QLabel* make_heading(const QString& text);
QLabel* make_text(const QString& text);  // wraps
// A verdict: the word is bold, its colour one of style.h's.
enum class Tone { plain, good, attention, alarm };
Tone tone_of(Verdict verdict);
void set_verdict(QLabel& label, const QString& text, Tone tone);
// Beside each other; what does not fit goes to the next line.
QLayout* make_row(std::initializer_list<QWidget*> widgets);
// Name above or beside a field, as its buddy and accessible name.
void add_field(QVBoxLayout& layout, const QString& label, QWidget* field, const QString& tip);

// Read only, one row selected at a time, first column left and the others right aligned;
// the last one wraps.
QTableWidget* make_table(const QString& name, const QStringList& header, const QString& tip);
// What is longer is cut with dots; its tip has all of it.
void elide_first_column(QTableWidget& table, int most_px);
void set_rows(QTableWidget& table, const QVector<QStringList>& rows);

// "12.34", with as many decimals as given; "-" for what is no number.
QString number(double value, int decimals);

// X, Y, Z in mm and KUKA's A, B, C in degrees; "-" for none.
std::array<double, 6> six(const Pose& pose);
QString frame_text(const std::optional<Pose>& pose, const QString& between = "  ");  // X Y Z, then A B C

}  // namespace seamwright
