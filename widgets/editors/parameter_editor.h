#pragma once
// One described setting (core/parameter.h) as a line to edit: name, value, unit, range.
//
// A number is typed with point or comma whatever the system's language; it is committed on Enter, on leaving
// the field, and by Up/Down (one unit of the last shown decimal's tenfold). What is refused stays in the
// field, marked by the word "refused" and the reason; Escape brings the last good value back. A choice is a
// list of its names.

#include <QStringList>
#include <QWidget>
#include <memory>
#include <optional>

#include "core/parameter.h"

namespace seamwright {

// Reads a number as people type it: blanks around, point or comma as decimal sign, exponent allowed, grouping
// not. Absent for anything else, also for "nan" and "inf".
std::optional<double> number_from_text(const QString& text);
// The same with its unit behind it ("30 mm"), which is one of these; a number without one too.
std::optional<double> number_from_text(const QString& text, const QStringList& units);
// The unit that stands behind a number; empty: none, or it is no number.
QString unit_behind_number(const QString& text);
// With `decimals` places, a point, and no negative zero.
QString text_from_number(double value, int decimals);

inline constexpr int kTypedSigns = 32;  // of what was typed, as a refusal says it again

class ParameterEditor : public QWidget {
    Q_OBJECT
  public:
    explicit ParameterEditor(const ParameterInfo& info, QWidget* parent = nullptr);
    ~ParameterEditor() override;
    const ParameterInfo& info() const;
    void set_name(const QString& name);  // in place of the word for info().name
    double value() const;
    void set_value(double value);  // no signal; clamped into the range (NaN: the default)
    // The same, of the thing that is shown: what is being typed stays as long as that is the same one.
    void refresh(double value, const std::string& of);
    bool refused() const;
    QString reason() const;  // why; empty when accepted

  signals:
    void committed(double value);  // accepted and different from before

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
