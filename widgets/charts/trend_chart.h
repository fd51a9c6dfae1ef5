#pragma once
// One quantity over parts: a dot per part and series, limits drawn, points beyond them ringed and counted in
// words.

#include <QString>
#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

namespace seamwright {

struct TrendSeries {
    QString name;                // "x", "a", ...
    std::vector<double> values;  // NaN = nothing measured; one per part
};

struct TrendLimits {
    std::optional<double> lower, upper;
};

class TrendChart : public QWidget {
    Q_OBJECT
  public:
    explicit TrendChart(QWidget* parent = nullptr);
    ~TrendChart() override;
    // `labels` and every series have one entry per part, oldest first. Unit: "mm", "deg".
    void set_data(const QString& title, const QString& unit, const std::vector<QString>& labels,
                  const std::vector<TrendSeries>& series, const TrendLimits& limits);
    int beyond_limits() const;  // dots outside the limits
    QPointF to_screen(int part, double value) const;
    QSize sizeHint() const override { return {640, 220}; }
    QSize minimumSizeHint() const override { return {240, 140}; }

  signals:
    void part_opened(int index);  // clicked, or Enter on the marked one

  protected:
    void changeEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
