# SPDX-License-Identifier: Apache-2.0
# Debian's Prometheus, for the composed server. Its configuration is mounted at /etc/prometheus.
FROM debian:bookworm-slim
COPY docker/packages.txt docker/install_packages.sh /packages/
RUN /packages/install_packages.sh prometheus && apt-get clean && rm -f /var/lib/apt/lists/*_* \
    && install -d -o 65532 -g 65532 /prometheus
LABEL org.opencontainers.image.title="Prometheus for Overtone" \
      org.opencontainers.image.licenses="Apache-2.0"
USER 65532:65532
EXPOSE 9090
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/prometheus", "--config.file=/etc/prometheus/prometheus.yml", "--storage.tsdb.path=/prometheus"]
