#pragma once
// What people expect of every list and table: Ctrl+C copies the chosen rows with tabs between the columns, the right button
// shows that and the list's own deeds.

#include <QAbstractItemView>
#include <QKeySequence>
#include <QObject>
#include <QPushButton>
#include <functional>

namespace seamwright {

// The rows that are chosen, as they are shown: a line each, tabs between the columns; hidden columns are left out, tabs and
// line ends within a cell become blanks. Of a tree: in the order of the screen.
QString chosen_rows(const QAbstractItemView& view);

// The button's deed by a key and in the menu of the list, as long as `applies` (none: always) and the button can be pressed.
void add_list_deed(QAbstractItemView& view, QPushButton& button, const QKeySequence& key,
                   std::function<bool()> applies = {});

// As an event filter of the application it sees every list.
class ListHabits : public QObject {
    Q_OBJECT
  public:
    using QObject::QObject;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace seamwright
