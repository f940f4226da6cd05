// What the two codecs of sim/animation.h share.
#pragma once

#include "sim/animation.h"
#include "sim/client.h"
#include "sim/server.h"

namespace pac::sim {

// The objects of the fine model as the path has them in that frame.
Result<void> pose(const AnimationOptions& options, int number, raster::Scene& fine);

ServerOptions server_options_for(const AnimationOptions& options, const Animation& out);
ClientOptions client_options_for(const AnimationOptions& options);

// The image-based arm's frame.
struct ImageArmFrame {
  const Bytes& code;
  double quality;
  const RgbImage& shown;
};

// Gives the packet to the client, holds its picture against the server's, scores both arms, tells the sink.
Result<void> show_frame(int number, const AnimationOptions& options, const AnimationSink& sink,
                        const ImageArmFrame& image, const Server& server, Client& client, const Bytes& packet,
                        Animation& out);

// sim/animation_mpeg1.cpp; split and size of `out` are set.
Result<void> run_mpeg1(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                       const AnimationSink& sink, Animation& out);

}  // namespace pac::sim
