#pragma once
// Residual of each spot of a region as bars in the sensor's x and z, with the spot's 3 sigma drawn.

#include <Eigen/Core>
#include <QString>
#include <QWidget>
#include <memory>
#include <vector>

namespace seamwright {

struct ResidualBar {
    QString spot;
    Eigen::Vector3d residual_mm = Eigen::Vector3d::Zero();  // sensor frame; y is not shown where 0
    double sigma_mm = 0;                                    // of a coordinate
    bool used = true;                                       // false: found wrong and left out
};

class ResidualBars : public QWidget {
    Q_OBJECT
  public:
    explicit ResidualBars(QWidget* parent = nullptr);
    ~ResidualBars() override;
    void set_data(const std::vector<ResidualBar>& bars);
    void select(const QString& spot);
    QSize sizeHint() const override { return {420, 220}; }
    QSize minimumSizeHint() const override { return {220, 140}; }

  signals:
    void spot_picked(QString spot);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
