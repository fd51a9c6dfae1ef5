#pragma once
// QCustomPlot as our plots use it: thin axes, faint grid, the window's font, colours from the palette.
//
// Axes, grid and slow plottables are drawn by QCustomPlot when they change and kept as one opaque picture;
// what moves with every frame is painted over it by paint_live(), only inside the region that was asked for,
// at most 60 times a second. Needs QCustomPlot's header: for implementation files of widgets/ only.

#include <qcustomplot.h>

#include <QElapsedTimer>
#include <QPixmap>
#include <QRegion>
#include <QTimer>

namespace seamwright {

class PlotCanvas : public QCustomPlot {
  public:
    explicit PlotCanvas(QWidget* parent = nullptr);

    // Pens, fonts and grounds from the palette; called by itself when palette or font change.
    virtual void apply_style();
    void request_live(const QRegion& region);  // paint_live() there within a sixtieth of a second
    void request_live() { request_live(QRegion(rect())); }
    void request_replot();  // axes and plottables too
    void flush();           // what is due is painted at once
    // One scale for both axes: the smallest ranges around this rectangle (x, y of the lower left, mm).
    void set_equal_view(const QRectF& view);
    bool equal_axes = false;  // kept through resizing

    static void style_axis(QCPAxis* axis, const QWidget& owner);

  protected:
    virtual void paint_live(QPainter& painter, const QRect& area);
    virtual void view_changed() {}  // axes or size are others: pixel positions no longer hold
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void changeEvent(QEvent* event) override;

  private:
    void keep_picture();
    void due();
    void equalise();
    void thin_ticks();

    QPixmap picture_;
    QTimer timer_;
    QElapsedTimer since_;
    QRegion wanted_;
    bool replot_wanted_ = false, styling_ = false;
};

}  // namespace seamwright
