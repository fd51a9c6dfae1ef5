#include "widgets/print/pdf.h"

#include <QAbstractTextDocumentLayout>
#include <QPainter>
#include <QSvgRenderer>
#include <QTextCursor>
#include <QTextDocument>
#include <QTextObjectInterface>
#include <QTextOption>
#include <QTextTable>
#include <cmath>
#include <memory>

#include "widgets/print/paged.h"

namespace seamwright {
namespace {

using report::Block;
using report::Tone;

constexpr int kPlotObject = QTextFormat::UserObject + 1;
constexpr int kSvgProperty = QTextFormat::UserProperty + 1;
constexpr int kWidthProperty = QTextFormat::UserProperty + 2;
constexpr double kTextPt = 9, kTablePt = 8, kWideTablePt = 6.5;
constexpr double kNoHeightPt = 1;
constexpr int kShortTable = 12;  // rows
constexpr double kFirstThird = 0.33, kLastThird = 0.66;
constexpr int kNear = 3;         // sentences between a heading and its table
constexpr int kKeptBlocks = 14;  // a sentence and two rows of six columns
constexpr int kWideColumns = 8;
constexpr double kWidePlotPx = 600;  // wider drawings get a line of their own

// What html.cpp's style sheet says about a plot, in what Qt's SVG reads.
constexpr const char* kPlotStyle =
    "<style type='text/css'>text { font-family: 'DejaVu Sans'; font-size: 11px; fill: #1e2226; } "
    ".title { font-weight: bold; } .grid { stroke: #e0e3e7; } .axes { fill: none; stroke: #6b7280; } "
    ".band { fill: #009E73; fill-opacity: 0.12; }</style>";

class PlotObject : public QObject, public QTextObjectInterface {
    Q_OBJECT
    Q_INTERFACES(QTextObjectInterface)

  public:
    QSizeF intrinsicSize(QTextDocument*, int, const QTextFormat& format) override {
        const double width = format.property(kWidthProperty).toDouble();
        const QSizeF size = renderer(format)->defaultSize();
        return {width, size.width() > 0 ? width * size.height() / size.width() : width};
    }
    void drawObject(QPainter* painter, const QRectF& where, QTextDocument*, int,
                    const QTextFormat& format) override {
        renderer(format)->render(painter, where);
    }

  private:
    static std::unique_ptr<QSvgRenderer> renderer(const QTextFormat& format) {
        return std::make_unique<QSvgRenderer>(format.property(kSvgProperty).toByteArray());
    }
};

QString q(const std::string& text) {
    return QString::fromStdString(text);
}

QByteArray styled(const std::string& svg) {
    QByteArray bytes = QByteArray::fromStdString(svg);
    const qsizetype head = bytes.indexOf('>');
    return head < 0 ? bytes : bytes.insert(head + 1, kPlotStyle);
}

QColor colour_of(Tone tone) {
    switch (tone) {
        case Tone::good:
            return QColor("#00664b");
        case Tone::attention:
            return QColor("#7a5200");
        case Tone::alarm:
            return QColor("#a33f00");
        case Tone::neutral:
            break;
    }
    return QColor("#1e2226");
}

// Lays the blocks into a document; lengths are in device pixels.
class Builder {
  public:
    Builder(QTextDocument& document, double width_px) : cursor_(&document), width_px_(width_px) {
        cursor_.beginEditBlock();
    }
    ~Builder() { cursor_.endEditBlock(); }

    void heading(const QString& text, int level) {
        const double pt = level <= 1 ? 17 : level == 2 ? 13 : 10.5;
        QTextBlockFormat format;
        format.setHeadingLevel(level);
        format.setTopMargin(points(level <= 1 ? 0 : level == 2 ? 24 : 16));
        format.setBottomMargin(points(6));
        begin(format);
        cursor_.insertText(text, characters(pt, QFont::DemiBold));
    }
    void add(const Block& b) {
        switch (b.kind) {
            case Block::Kind::heading:
                return heading(q(b.text), b.level);
            case Block::Kind::paragraph:
                begin(plain());
                cursor_.insertText(q(b.text), characters(kTextPt));
                return;
            case Block::Kind::verdict: {
                begin(plain());
                QTextCharFormat word = characters(kTextPt + 1, QFont::Bold);
                word.setForeground(colour_of(b.tone));
                cursor_.insertText(q(b.word), word);
                if (!b.text.empty()) cursor_.insertText("   " + q(b.text), characters(kTextPt));
                return;
            }
            case Block::Kind::table:
                return table(b);
            case Block::Kind::figures:
                return figures(b);
            case Block::Kind::signatures:
                for (const auto& line : b.rows) signature(line);
                return;
        }
    }

  private:
    // Lengths in formats are Qt's pixels of 96 to the inch, which it scales to the device.
    static double points(double pt) { return pt * 96 / 72; }
    static QTextCharFormat characters(double pt, int weight = QFont::Normal) {
        QTextCharFormat format;
        format.setFontFamilies({"DejaVu Sans"});
        format.setFontPointSize(pt);
        format.setFontWeight(weight);
        format.setForeground(QColor("#1e2226"));
        return format;
    }
    static QTextBlockFormat plain() {
        QTextBlockFormat format;
        format.setTopMargin(points(4));
        format.setBottomMargin(points(4));
        return format;
    }
    void begin(const QTextBlockFormat& format) {
        cursor_.movePosition(QTextCursor::End);
        if (empty_) {
            cursor_.setBlockFormat(format);
            cursor_.setBlockCharFormat(characters(kTextPt));
        } else {
            cursor_.insertBlock(format, characters(kTextPt));
        }
        empty_ = false;
    }
    // Qt keeps an empty block before and behind a table: both are made as low as they can be.
    QTextTable* insert_table(int rows, int columns, const QTextTableFormat& format) {
        begin(QTextBlockFormat());
        cursor_.setBlockCharFormat(characters(kNoHeightPt));
        QTextTable* table = cursor_.insertTable(rows, columns, format);
        cursor_.movePosition(QTextCursor::End);
        cursor_.setBlockFormat(QTextBlockFormat());
        cursor_.setBlockCharFormat(characters(kNoHeightPt));
        return table;
    }
    void table(const Block& b) {
        if (!b.text.empty()) {
            begin(plain());
            QTextCharFormat caption = characters(kTablePt);
            caption.setForeground(QColor("#4b5563"));
            cursor_.insertText(q(b.text), caption);
        }
        const int rows = static_cast<int>(b.rows.size()), columns = static_cast<int>(b.rows[0].size());
        const double pt = columns >= kWideColumns ? kWideTablePt : kTablePt;
        QTextTableFormat format;
        format.setHeaderRowCount(1);
        format.setBorder(0);
        format.setCellPadding(points(3.5));
        format.setCellSpacing(0);
        format.setTopMargin(points(6));
        format.setBottomMargin(0);  // at the foot of a page it would repeat the table's head on the next
        format.setBorderCollapse(true);
        QTextTable* t = insert_table(rows, columns, format);
        const std::vector<bool> numeric = report::numeric_columns(b.rows);
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c) {
                QTextTableCell cell = t->cellAt(r, c);
                QTextTableCellFormat look = cell.format().toTableCellFormat();
                look.setBottomBorderStyle(QTextFrameFormat::BorderStyle_Solid);
                look.setBottomBorder(points(r == 0 ? 1.2 : 0.5));
                look.setBottomBorderBrush(QColor(r == 0 ? "#6b7280" : "#c3c8ce"));
                cell.setFormat(look);
                QTextCursor in = cell.firstCursorPosition();
                QTextBlockFormat block;
                block.setAlignment(numeric[static_cast<std::size_t>(c)] ? Qt::AlignRight : Qt::AlignLeft);
                in.setBlockFormat(block);
                const auto& row = b.rows[static_cast<std::size_t>(r)];
                if (c < static_cast<int>(row.size()))
                    in.insertText(q(row[static_cast<std::size_t>(c)]),
                                  characters(pt, r == 0 ? QFont::DemiBold : QFont::Normal));
            }
    }
    void figures(const Block& b) {
        QTextBlockFormat format = plain();
        format.setNonBreakableLines(false);
        begin(format);
        for (const std::string& svg : b.svgs) {
            const double share =
                QSvgRenderer(QByteArray::fromStdString(svg)).defaultSize().width() > kWidePlotPx ? 0.98
                                                                                                 : 0.49;
            QTextCharFormat plot;
            plot.setObjectType(kPlotObject);
            plot.setProperty(kSvgProperty, styled(svg));
            plot.setProperty(kWidthProperty, width_px_ * share);
            cursor_.insertText(QString(QChar::ObjectReplacementCharacter), plot);
        }
        if (b.text.empty()) return;
        begin(plain());
        QTextCharFormat caption = characters(kTablePt);
        caption.setForeground(QColor("#4b5563"));
        cursor_.insertText(q(b.text), caption);
    }
    void signature(const std::vector<std::string>& fields) {
        QTextTableFormat format;
        format.setBorder(0);
        format.setCellSpacing(points(8));
        format.setWidth(QTextLength(QTextLength::PercentageLength, 100));
        format.setColumnWidthConstraints(QList<QTextLength>(
            static_cast<qsizetype>(fields.size()),
            QTextLength(QTextLength::PercentageLength, 100.0 / static_cast<double>(fields.size()))));
        format.setTopMargin(points(52));
        QTextTable* t = insert_table(1, static_cast<int>(fields.size()), format);
        for (int c = 0; c < t->columns(); ++c) {
            QTextTableCell cell = t->cellAt(0, c);
            QTextTableCellFormat look = cell.format().toTableCellFormat();
            look.setTopBorderStyle(QTextFrameFormat::BorderStyle_Solid);
            look.setTopBorder(points(0.8));
            look.setTopBorderBrush(QColor("#1e2226"));
            look.setTopPadding(points(3));
            cell.setFormat(look);
            cell.firstCursorPosition().insertText(q(fields[static_cast<std::size_t>(c)]),
                                                  characters(kTablePt));
        }
    }

    QTextCursor cursor_;
    double width_px_;
    bool empty_ = true;  // the last block waits for its content
};

// Where pages end. A heading never stands alone at the foot of a page: it goes to the next one, and so it does with little
// more than a sentence or a table's head, from a page's last third. A short table stands on one page, with its heading
// where that is near.
class PageBreaks {
  public:
    PageBreaks(QTextDocument& document, double page_px)
        : document_(document), layout_(*document.documentLayout()), page_px_(page_px) {}
    // From the first block on: a break moves only what comes behind it.
    void set() {
        for (QTextBlock b = document_.begin(); b.isValid(); b = b.next()) {
            QTextTable* table = QTextCursor(b).currentTable();
            if (b.blockFormat().headingLevel() > 0)
                heading(b);
            else if (table && table->cellAt(0, 0).firstCursorPosition().block() == b && parted(*table))
                before(*table);
        }
    }

  private:
    int page_of(const QTextBlock& b) const {
        return static_cast<int>(layout_.blockBoundingRect(b).top() / page_px_);
    }
    bool parted(QTextTable& table) const {
        return table.rows() <= kShortTable &&
               page_of(table.cellAt(0, 0).firstCursorPosition().block()) !=
                   page_of(table.cellAt(table.rows() - 1, 0).firstCursorPosition().block());
    }
    static void before(QTextTable& table) {
        QTextTableFormat format = table.format();
        format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
        table.setFormat(format);
    }
    void heading(const QTextBlock& b) const {
        const double at = std::fmod(layout_.blockBoundingRect(b).top(), page_px_) / page_px_;
        const int wanted = at > kLastThird ? kKeptBlocks : 1;
        bool away = false;
        int shown = 0;
        // The next blocks that have something to show, up to a drawing.
        for (QTextBlock next = b.next(); next.isValid() && shown < kKeptBlocks; next = next.next()) {
            if (next.length() <= 1) continue;
            if (next.blockFormat().headingLevel() > 0) {
                if (shown > 0) break;
                continue;
            }
            if (QTextTable* table = QTextCursor(next).currentTable()) {
                away = away || (at > kFirstThird && shown <= kNear && parted(*table));
                if (shown >= wanted) break;
            }
            ++shown;
            away = away || (shown <= wanted && page_of(next) != page_of(b));
            if (next.text().contains(QChar::ObjectReplacementCharacter)) break;
        }
        if (!away) return;
        QTextCursor cursor(b);
        QTextBlockFormat format = b.blockFormat();
        format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
        cursor.setBlockFormat(format);
    }

    QTextDocument& document_;
    const QAbstractTextDocumentLayout& layout_;
    double page_px_;
};

}  // namespace

Expected<void> write_pdf(const report::Page& page, const std::filesystem::path& path) {
    PlotObject plots;
    return write_paged(path, q(page.title()), [&](QTextDocument& document, QSizeF page_px) {
        document.setDocumentMargin(0);
        document.setDefaultFont(QFont("DejaVu Sans", static_cast<int>(kTextPt)));
        document.documentLayout()->registerHandler(kPlotObject, &plots);
        {
            Builder builder(document, page_px.width());
            builder.heading(q(page.title()), 1);
            for (const Block& b : page.blocks()) builder.add(b);
        }
        PageBreaks(document, page_px.height()).set();
    });
}

}  // namespace seamwright

#include "pdf.moc"
