#pragma once
// The line over a view: what it shows, and its tools at the right.

#include <QLabel>
#include <QToolButton>
#include <QWidget>

namespace seamwright {

class FlowLayout;

class ViewBar : public QWidget {
  public:
    explicit ViewBar(QWidget* parent, const QString& caption = {});
    QLabel* caption() { return caption_; }
    // Large enough for a glove; its word is its accessible name.
    QToolButton* add(const QString& word, const QString& tip, bool checkable = false);

  private:
    FlowLayout* row_;
    QLabel* caption_;
};

}  // namespace seamwright
