#pragma once
// Ctrl+K: every action of the window by a few letters of its name.

#include <QAction>
#include <QDialog>
#include <QLineEdit>
#include <QListWidget>

namespace seamwright {

// How well the letters of `typed` appear in order in `text` (case and blanks do not matter); negative = not.
// Beginnings of words and runs count more.
int fuzzy_score(const QString& typed, const QString& text);

class CommandPalette : public QDialog {
    Q_OBJECT
  public:
    CommandPalette(const QList<QAction*>& actions, QWidget* parent);

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void fill(const QString& typed);
    void run();
    QList<QAction*> actions_;
    QLineEdit* input_;
    QListWidget* list_;
};

}  // namespace seamwright
