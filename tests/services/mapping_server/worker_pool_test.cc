// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/worker_pool.h"

#include <atomic>
#include <functional>
#include <stdexcept>
#include <vector>

#include "absl/synchronization/barrier.h"
#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

TEST(WorkerPool, OneThreadTakesTasksInTheirOrder) {
  std::vector<int> order;  // of the pool's one thread
  absl::Notification done;
  WorkerPool pool(1);
  for (int i = 0; i < 5; ++i) {
    pool.Post([&order, i] { order.push_back(i); });
  }
  pool.Post([&] { done.Notify(); });
  done.WaitForNotification();
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3, 4));
}

TEST(WorkerPool, WhatATaskPostsComesAfterWhatWaits) {
  std::vector<int> order;
  absl::Notification all_posted, done;
  WorkerPool pool(1);
  pool.Post([&] {
    all_posted.WaitForNotification();
    pool.Post([&] {
      order.push_back(3);
      done.Notify();
    });
    order.push_back(1);
  });
  pool.Post([&] { order.push_back(2); });
  all_posted.Notify();
  done.WaitForNotification();
  EXPECT_THAT(order, ElementsAre(1, 2, 3));
}

// Each waits for the other, so one thread would wait forever.
TEST(WorkerPool, TwoThreadsRunTwoTasksAtOnce) {
  auto* both = new absl::Barrier(2);
  std::atomic<int> met = 0;
  absl::Notification done;
  WorkerPool pool(2);
  for (int i = 0; i < 2; ++i) {
    pool.Post([&, both] {
      if (both->Block()) delete both;
      if (++met == 2) done.Notify();
    });
  }
  EXPECT_TRUE(done.WaitForNotificationWithTimeout(absl::Seconds(20)));
}

TEST(WorkerPool, ATaskThatThrowsEndsNeitherThreadNorCount) {
  absl::Notification done;
  WorkerPool pool(1);
  pool.Post([] { throw std::runtime_error("out of order"); });
  pool.Post([&] {
    EXPECT_EQ(pool.backlog(), 1);  // itself
    done.Notify();
  });
  EXPECT_TRUE(done.WaitForNotificationWithTimeout(absl::Seconds(20)));
}

TEST(WorkerPool, TheBacklogHoldsWhatWaitsAndWhatIsUnderWay) {
  absl::Notification begun, go_on, at_last, done;
  WorkerPool pool(1);
  EXPECT_EQ(pool.backlog(), 0);
  pool.Post([&] {
    begun.Notify();
    go_on.WaitForNotification();
  });
  pool.Post([&] {
    at_last.WaitForNotification();
    done.Notify();
  });
  begun.WaitForNotification();
  EXPECT_EQ(pool.backlog(), 2);
  go_on.Notify();
  while (pool.backlog() == 2) {
  }
  EXPECT_EQ(pool.backlog(), 1);
  at_last.Notify();
  done.WaitForNotification();
  while (pool.backlog() > 0) {
  }
}

// A task that posts its own successor never lets the queue run dry.
TEST(WorkerPool, TheDestructorDropsWhatWaits) {
  std::atomic<int> rounds = 0;
  std::function<void()> again;
  {
    WorkerPool pool(1);
    again = [&pool, &again, &rounds] {
      ++rounds;
      pool.Post(again);
    };
    pool.Post(again);
    while (rounds < 10) {
    }
  }
  EXPECT_GE(rounds, 10);
}

TEST(WorkerPool, WithoutThreadsTasksOnlyWait) {
  WorkerPool pool(0);
  pool.Post([] { FAIL(); });
  EXPECT_EQ(pool.backlog(), 1);
}

}  // namespace
}  // namespace overtone
