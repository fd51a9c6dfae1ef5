#include "projects/file/json_archive.h"

#include "devices/exchange/pose_json.h"

namespace seamwright {

nlohmann::json JsonWriter::encode(const Pose& pose) {
    if (pose.matrix().allFinite()) return pose_json(pose);
    JsonWriter writer(ArchiveOptions{});
    return {{"matrix", writer.encode(Eigen::Matrix4d(pose.matrix()))}};
}

void JsonReader::decode(const nlohmann::json& json, Pose& pose) {
    if (!json.is_object()) return expected("a pose", json);
    const auto field = json.find("matrix");
    if (options_.rigid_poses || field == json.end()) {
        auto parsed = parse_pose(json, path_);
        if (!parsed) {
            if (!error_) error_ = parsed.error();
            return;
        }
        pose = *parsed;
        if (field == json.end()) return;
    }
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    if (field->is_array() && field->size() == 4 && field->front().is_array()) {
        for (std::size_t r = 0; r < 4 && !error_; ++r) {
            Eigen::Vector4d row = Eigen::Vector4d::Zero();
            decode((*field)[r], row);
            m.row(static_cast<int>(r)) = row;
        }
    } else {
        decode(*field, m);
    }
    if (error_) return;
    if (options_.rigid_poses) {
        // The stored bits are kept when they are a rotation to rounding; a hand-written one is made
        // orthonormal.
        if ((pose.matrix() - m).cwiseAbs().maxCoeff() > 1e-9) m = pose.matrix();
    } else if (const auto xyz = json.find("xyz"); xyz != json.end()) {
        // A result need not be rigid, so that its angles may say nothing; what stands beside it was written
        // with it all the same.
        Eigen::Vector3d beside = Eigen::Vector3d::Zero();
        decode(*xyz, beside);
        if (!error_ && !(beside - m.topRightCorner<3, 1>()).isZero(0)) fail("xyz contradicts the matrix");
    }
    pose.matrix() = m;
    pose.makeAffine();
}

}  // namespace seamwright
