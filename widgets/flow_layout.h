#pragma once
// Widgets beside each other, in as many lines as the width asks for: a row of buttons loses none of its words
// when the language or the text size makes them longer.

#include <QLayout>
#include <QList>

namespace seamwright {

class FlowLayout : public QLayout {
  public:
    // `last_to_the_right`: all but the first widget stand at the right end of their line (a caption, then
    // tools).
    explicit FlowLayout(QWidget* parent = nullptr, bool last_to_the_right = false);
    ~FlowLayout() override;

    void addItem(QLayoutItem* item) override { items_ << item; }
    int count() const override { return static_cast<int>(items_.size()); }
    QLayoutItem* itemAt(int index) const override { return items_.value(index); }
    QLayoutItem* takeAt(int index) override;
    Qt::Orientations expandingDirections() const override { return {}; }
    bool hasHeightForWidth() const override { return true; }
    int heightForWidth(int width) const override { return place(QRect(0, 0, width, 0), false); }
    QSize minimumSize() const override;  // the widest widget, one line
    QSize sizeHint() const override;     // all in one line
    void setGeometry(const QRect& rect) override;

  private:
    int place(const QRect& rect, bool really) const;  // the height it takes
    QList<QLayoutItem*> items_;
    bool last_to_the_right_;
};

}  // namespace seamwright
