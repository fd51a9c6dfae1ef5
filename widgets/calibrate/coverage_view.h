#pragma once
// How well captures cover the field of view (left) and the orientations (right: tilt of the sight line, tick
// = turn about it). Where nothing was seen the solution extrapolates.

#include <QWidget>
#include <optional>
#include <vector>

#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/guide.h"

namespace seamwright {

struct CoverageEntry {
    EntryPicture picture;
    bool used = true;
    bool selected = false;
};

class CoverageView : public QWidget {
    Q_OBJECT
  public:
    explicit CoverageView(QWidget* parent = nullptr);
    // `next`: tilt and turn of the proposed pose, drawn hollow. `selected`: id of the capture to lift out.
    void set_data(std::vector<CoverageEntry> entries, std::vector<ViewMark> marks,
                  const std::optional<ViewMark>& next, const QString& selected);
    double covered_share() const { return share_; }  // of the field's cells, 0..1
    QSize sizeHint() const override { return {400, 190}; }
    QSize minimumSizeHint() const override { return {240, 160}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    void paint_field(QPainter& painter, const QRectF& box) const;
    void paint_views(QPainter& painter, const QRectF& box) const;
    void measure();
    std::vector<CoverageEntry> entries_;
    std::vector<ViewMark> marks_;
    std::optional<ViewMark> next_;
    QString selected_;
    double left_ = 0, right_ = 1, low_ = 0, high_ = 1;
    bool pixels_ = false;
    std::vector<int> cells_;
    double share_ = 0;
};

}  // namespace seamwright
