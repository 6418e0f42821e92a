# SPDX-License-Identifier: Apache-2.0
# The mapping server, the command `overtone` and the probe `overtone-health`, with the libraries that they load and nothing else.
#   DOCKER_BUILDKIT=1 docker build -f docker/server.Dockerfile -t overtone-server .      (--build-arg TESTS=ON: runs the unit tests)
FROM debian:bookworm-slim AS build
COPY docker/packages.txt docker/install_packages.sh /packages/
ARG TESTS=OFF
RUN /packages/install_packages.sh client server $([ "$TESTS" = OFF ] || echo test)
# The sources are only looked at, so that no layer holds them or what the compiler makes of them.
RUN --mount=type=bind,target=/src,rw --mount=type=cache,id=overtone-ccache,target=/root/.cache/ccache \
    cd /src && docker/build.sh release overtone_mapping_server overtone_cli overtone_health \
    && docker/runtime_root.sh /runtime overtone-server "client server" build/release/services/mapping_server/overtone-mapping-server \
       build/release/client/cli/overtone build/release/services/health_probe/overtone-health \
    && cp docker/config/mapping_server.yaml /runtime/etc/overtone/

FROM scratch
COPY --from=build /runtime /
ARG REVISION=unknown
LABEL org.opencontainers.image.title="Overtone mapping server" \
      org.opencontainers.image.description="Collaborative multi-robot mapping: submaps in, one optimised map out" \
      org.opencontainers.image.licenses="Apache-2.0" \
      org.opencontainers.image.version="0.1.0" \
      org.opencontainers.image.revision="${REVISION}" \
      org.opencontainers.image.base.name="scratch"
USER 65532:65532
WORKDIR /var/lib/overtone
EXPOSE 7077 9464
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=5s --timeout=3s --start-period=60s --retries=3 \
  CMD ["/usr/bin/overtone-health", "--service", "overtone.v1.MappingService", "--tls-ca", "/etc/overtone/certs/ca.crt", \
       "--tls-cert", "/etc/overtone/certs/operator-probe.crt", "--tls-key", "/etc/overtone/certs/operator-probe.key"]
ENTRYPOINT ["/usr/bin/overtone-mapping-server"]
CMD ["--config", "/etc/overtone/mapping_server.yaml"]
