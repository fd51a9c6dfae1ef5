#pragma once
// One line drawing a method: what stands where.

#include <QString>
#include <QWidget>

namespace seamwright {

class MethodDrawing : public QWidget {
    Q_OBJECT
  public:
    explicit MethodDrawing(QWidget* parent = nullptr);
    void set_method(const QString& id);
    QSize sizeHint() const override { return {150, 150}; }
    QSize minimumSizeHint() const override { return {120, 120}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    QString id_;
};

}  // namespace seamwright
