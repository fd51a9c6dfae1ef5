#pragma once
// Distribution of one quantity, or of several of one unit beside each other, with limits and process capability.

#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

#include "widgets/charts/trend_chart.h"

namespace seamwright {

// Process capability (ISO 22514-2, method of the standard deviation):
//     Cp  = (U - L) / (6 s),      Cpk = min(U - mean, mean - L) / (3 s)
// with s the sample standard deviation (n - 1) of all values. Assumption: independent values of one stable,
// normal process; a trend, two batches or outliers make both meaningless, and below about 50 values they
// scatter by 10 % and more (standard deviation of Cp about Cp / sqrt(2 (n - 1))). With one limit only Cpk
// exists. Non-finite values are left out.
struct ShownCapability {
    int count = 0;
    double mean = 0, standard_deviation = 0;  // NaN with fewer than 1 / 2 values
    std::optional<double> cp, cpk;            // absent: a limit is missing, fewer than 2 values, or s = 0
};
ShownCapability capability(const std::vector<double>& values, const TrendLimits& limits);

class Histogram : public QWidget {
    Q_OBJECT
  public:
    explicit Histogram(QWidget* parent = nullptr);
    ~Histogram() override;
    // Classes: Freedman-Diaconis width, 5 to 60 of them. `of_process` false: the values are no process's, and neither
    // Cp nor Cpk is said.
    void set_data(const QString& title, const QString& unit, const std::vector<double>& values,
                  const TrendLimits& limits, bool of_process = true);
    // Of each series its own, in its colour of the trend chart: what is put together would let their means cancel and count
    // each part several times.
    void set_data(const QString& title, const QString& unit, const std::vector<TrendSeries>& series,
                  const TrendLimits& limits, bool of_process = true);
    const ShownCapability& shown(std::size_t series = 0) const;
    QSize sizeHint() const override { return {360, 220}; }
    QSize minimumSizeHint() const override { return {200, 140}; }

  protected:
    void changeEvent(QEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
