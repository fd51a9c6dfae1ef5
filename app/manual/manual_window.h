#pragma once
// The manual beside the program: contents and search on the left, the page on the right. Not modal: an engineer reads and
// works.

#include <QLineEdit>
#include <QListWidget>
#include <QTextBrowser>
#include <QWidget>

namespace seamwright {

class ManualWindow : public QWidget {
    Q_OBJECT
  public:
    ManualWindow(const QString& language, QWidget* parent);
    void show_page(const QString& page);  // one of manual_pages(); any other: the first
    QString page() const;

  private:
    void search(const QString& words);
    void mark();  // the searched words, on the page that is shown
    QString language_;
    QLineEdit* words_;
    QListWidget* contents_;
    QTextBrowser* text_;
};

}  // namespace seamwright
