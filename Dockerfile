# The demo in the container of ROS 2 Jazzy:
#   docker build --tag furuta . && docker run --rm --volume "$PWD/output:/output" furuta
# It writes a figure, a bag and summary.json to output/demo.
FROM ros:jazzy AS dependencies
WORKDIR /furuta
COPY .ci .ci
COPY furuta_ws/src furuta_ws/src
RUN .ci/jazzy install && rm -rf /var/lib/apt/lists/*

FROM dependencies AS demo
COPY . .
RUN .ci/jazzy build
COPY --chmod=755 <<'SCRIPT' /furuta/entrypoint
#!/bin/bash
source /opt/ros/jazzy/setup.bash
source /furuta/furuta_ws/install/setup.bash
exec "$@"
SCRIPT
ENTRYPOINT ["/furuta/entrypoint"]
CMD ["ros2", "run", "furuta_bringup", "furuta", "demo", "--out", "/output/demo"]
