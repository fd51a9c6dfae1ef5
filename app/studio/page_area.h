#pragma once
// The scrolling area of a step's page, over whose lower end a message may lie.

#include <QScrollArea>
#include <QScrollBar>

namespace seamwright {

class PageArea : public QScrollArea {
  public:
    explicit PageArea(QWidget* page, QWidget* parent = nullptr) : QScrollArea(parent) {
        setWidgetResizable(true);
        setFrameShape(NoFrame);
        setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
        setFocusPolicy(Qt::NoFocus);
        setWidget(page);
    }

    // The lowest `px` are taken: the page ends above them, and can be scrolled to its end. Nothing on it moves by that; a page
    // that has nothing there is left as it is.
    void keep_free(int px) {
        const bool has_more = verticalScrollBar()->maximum() > 0 || viewportMargins().bottom() > 0;
        if (px > 0 && !has_more && widget()->childrenRect().bottom() < viewport()->height() - px) px = 0;
        if (px == viewportMargins().bottom()) return;
        widget()->setMinimumHeight(px > 0 ? widget()->height() : 0);
        setViewportMargins(0, 0, 0, px);
    }
};

}  // namespace seamwright
