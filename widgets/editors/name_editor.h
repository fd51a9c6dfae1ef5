#pragma once
// A name that the project may refuse: a line, and below it the word "refused" with the reason, as a ParameterEditor has it.
// What is refused stays in the line as it was typed, until it is mended or Escape brings back what holds.

#include <QWidget>
#include <functional>
#include <string>

#include "core/error.h"

class QLabel;
class QLineEdit;

namespace seamwright {

class NameEditor : public QWidget {
    Q_OBJECT
  public:
    // Gets the name without blanks at its ends, when the line is left or Return is pressed.
    using Take = std::function<Expected<void>(const std::string& name)>;

    NameEditor(const QString& name, const QString& tip, Take take, QWidget* parent = nullptr);
    // What holds. What is being typed for the same `of` stays.
    void refresh(const std::string& name, const std::string& of);
    bool refused() const;
    QLineEdit& line() { return *line_; }

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void show_held();
    void take_typed();
    Take take_;
    QLineEdit* line_;
    QLabel* problem_;
    std::string held_, of_;
};

}  // namespace seamwright
