#pragma once
// What a whole is made of: one bar a line with its name before and its figure behind, largest first as given.

#include <QString>
#include <QWidget>
#include <vector>

namespace seamwright {

struct ShareOfWhole {
    QString name;
    double percent = 0;       // 0..100
    bool systematic = false;  // else random; the figure says it in words
};

class ShareBars : public QWidget {
    Q_OBJECT
  public:
    explicit ShareBars(QWidget* parent = nullptr);
    void set_data(std::vector<ShareOfWhole> shares);
    const std::vector<ShareOfWhole>& shown() const { return shares_; }
    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    static QString figure(const ShareOfWhole& share);
    int row_height() const;
    std::vector<ShareOfWhole> shares_;
};

}  // namespace seamwright
